// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "core/result.h"

namespace relume {

/// Bytes that a tree of Embree's over so many triangles takes, with what builds it.
std::size_t embree_memory(std::size_t triangles);

/// That there is less (out_of_memory).
Error no_embree_memory(std::size_t triangles);

/// Whether memory is left for a tree of Embree's over so many triangles (out_of_memory). Embree ends the
/// process where memory runs out while its builder starts threads, so whoever builds asks first.
Result<void> check_embree_memory(std::size_t triangles);

}  // namespace relume
