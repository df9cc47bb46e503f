// SPDX-License-Identifier: MIT
#include "core/piece_samples.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace relume {

std::uint32_t piece_sample_count(double texels) {
  constexpr double kPerTexel = 8.0, kLeast = 16.0, kMost = 256.0;
  const double wanted = kPerTexel * texels;
  return static_cast<std::uint32_t>(wanted < kMost ? std::max(wanted, kLeast) : kMost);
}

glm::dvec2 piece_sample(std::uint32_t i, const PieceCorners& corners) {
  double u = std::fmod(0.5 + 0.7548776662466927 * (i + 1), 1.0);
  double v = std::fmod(0.5 + 0.5698402909980532 * (i + 1), 1.0);
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const glm::dvec2 a(corners[0]);
  return a + u * (glm::dvec2(corners[1]) - a) + v * (glm::dvec2(corners[2]) - a);
}

double piece_share(const PieceCorners& corners) {
  const glm::dvec2 a = glm::dvec2(corners[1]) - glm::dvec2(corners[0]);
  const glm::dvec2 b = glm::dvec2(corners[2]) - glm::dvec2(corners[0]);
  return std::abs(a.x * b.y - a.y * b.x);
}

double triangle_area(const Occluders& occluders, std::uint32_t triangle) {
  const auto& corners = occluders.triangles[triangle];
  const glm::dvec3 a(occluders.positions[corners[0]]);
  const glm::dvec3 b(occluders.positions[corners[1]]);
  const glm::dvec3 c(occluders.positions[corners[2]]);
  return glm::length(glm::cross(b - a, c - a)) / 2.0;
}

}  // namespace relume
