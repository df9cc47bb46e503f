// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>

namespace relume::test {

/// How often a test repeats what is random: as the environment variable says, which tests/nightly sets, else
/// `few`.
inline int repeats(const char* variable, int few) {
  const char* said = std::getenv(variable);
  const int times = said ? std::atoi(said) : 0;
  return times > 0 ? times : few;
}

}  // namespace relume::test
