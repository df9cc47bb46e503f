// SPDX-License-Identifier: MIT
#include "core/piece_samples.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

namespace relume {
namespace {

constexpr std::uint32_t kMostSamples = 256;

glm::dvec2 barycentric_sample(std::uint32_t i) {
  const double u = std::fmod(0.5 + 0.7548776662466927 * (i + 1), 1.0);
  const double v = std::fmod(0.5 + 0.5698402909980532 * (i + 1), 1.0);
  return u + v > 1.0 ? glm::dvec2(1.0 - u, 1.0 - v) : glm::dvec2(u, v);
}

}  // namespace

std::uint32_t piece_sample_count(double texels) {
  constexpr double kPerTexel = 8.0, kLeast = 16.0;
  const double wanted = kPerTexel * texels;
  return wanted < kMostSamples ? static_cast<std::uint32_t>(std::max(wanted, kLeast)) : kMostSamples;
}

glm::dvec2 piece_sample(std::uint32_t i, const PieceCorners& corners) {
  static const std::vector<glm::dvec2> known = [] {
    std::vector<glm::dvec2> points;
    for (std::uint32_t k = 0; k < kMostSamples; ++k) points.push_back(barycentric_sample(k));
    return points;
  }();
  const glm::dvec2 at = i < known.size() ? known[i] : barycentric_sample(i);
  const glm::dvec2 a(corners[0]);
  return a + at.x * (glm::dvec2(corners[1]) - a) + at.y * (glm::dvec2(corners[2]) - a);
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
