// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>

namespace relume::test {

/// For what libraries of pictures allocate.
struct FreeMemory {
  void operator()(void* memory) const { std::free(memory); }
};

}  // namespace relume::test
