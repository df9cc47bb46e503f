// SPDX-License-Identifier: MIT
//
// Names of triangles and elements that stay the same while nothing about them changes, whatever is added to
// the scene or taken out of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/emitters.h"
#include "precompute/sender_lookup.h"

namespace relume {

/// Per triangle: its corners, its normal, whether it has a back, and what it lets through. Not its material's
/// name or colours.
std::vector<std::uint64_t> triangle_keys(const Geometry& geometry);

/// Names elements by their chart (its triangles, where they lie in it, which of them share a material), their
/// place in it, the pieces that they are made of, and whether a wall is near.
class ElementNamer {
 public:
  /// Borrows the keys of the triangles.
  ElementNamer(const Geometry& geometry, const std::vector<std::uint64_t>& triangles,
               const std::vector<Chart>& charts, const std::vector<AtlasLayout>& layouts);

  /// Of the `number`-th of `count` elements of its cell, in a lightmap of this width. Never 0.
  std::uint64_t key(std::uint32_t width, const Element& element, std::span<const Piece> pieces,
                    std::uint32_t number, std::uint32_t count) const;

 private:
  const std::vector<std::uint64_t>& triangles_;
  std::vector<std::uint64_t> charts_;
  std::vector<glm::uvec2> positions_;  ///< per chart
};

/// Per element of all systems. Elements that nothing tells apart (of charts that lie in each other) have 0.
std::vector<std::uint64_t> element_keys(const ElementNamer& namer,
                                        const std::vector<ClusteredSurface>& surfaces);

/// Of all possible emitters: where they are, and in which order.
std::uint64_t emitters_key(const Emitters& emitters);

}  // namespace relume
