// SPDX-License-Identifier: MIT
//
// Names of triangles and elements that stay the same while nothing about them changes, whatever is added to
// the scene or taken out of it.
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/emitters.h"
#include "precompute/sender_lookup.h"

namespace relume {

/// Per triangle: its corners, its normal, whether it has a back, and what it lets through. Not its material's
/// name or colours.
std::vector<std::uint64_t> triangle_keys(const Geometry& geometry);

/// Per element of all systems: its chart, its place in it, the pieces that it is made of, and whether a wall
/// is near. Elements that nothing tells apart (of charts that lie in each other) have 0.
std::vector<std::uint64_t> element_keys(const std::vector<std::uint64_t>& triangles,
                                        const std::vector<Chart>& charts,
                                        const std::vector<SystemLayout>& layouts,
                                        const std::vector<ClusteredSurface>& surfaces);

/// Of all possible emitters: where they are, and in which order.
std::uint64_t emitters_key(const Emitters& emitters);

}  // namespace relume
