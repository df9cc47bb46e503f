// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <span>

namespace relume {

inline float largest_coordinate(std::span<const glm::vec3> positions) {
  float largest = 0.0f;
  for (const glm::vec3& p : positions)
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

/// How far (m) points are lifted off the surface that they lie on before rays leave them or reach them: 2^-18
/// of the largest coordinate, about 20 um in a room of 5 m; the rounding of an interpolated single-precision
/// point is below 2^-22 of it.
inline float ray_offset(std::span<const glm::vec3> positions) {
  return largest_coordinate(positions) * 0x1p-18f;
}

}  // namespace relume
