// SPDX-License-Identifier: MIT
//
// Bounce matrices of empty box rooms in a row, by quadrature: no rays, no precompute.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "core/block_matrix.h"

namespace relume::test {

struct BoxRooms {
  CsrMatrix matrix;
  std::vector<double> areas;
  std::vector<glm::vec3> centroids;
  std::vector<std::uint32_t> room;  ///< of each patch
  std::uint32_t rooms = 0;
  std::size_t size() const { return areas.size(); }
};

/// `count` rooms of 4 x 5 x 3 m in a row, each joined to the next by a door of 1 x 2 m, which lie at both
/// ends of the walls in turn. Patches of about `patch` m. Form factors between middles of patches, cos cos A
/// / (pi r^2), seen through all doors between them; then scaled from both sides (R. Sinkhorn, 1964) until A K
/// is symmetric and every row sums to 1.
BoxRooms box_rooms(std::uint32_t count, double patch);

/// The same before the scaling: rows of patches in corners sum to more than 1.
BoxRooms unscaled_box_rooms(std::uint32_t count, double patch);

/// Rows from `rays` random draws of the columns of each row of `exact`, in proportion to their form factors.
CsrMatrix noisy_rows(const CsrMatrix& exact, std::uint32_t rays, std::uint64_t seed);

}  // namespace relume::test
