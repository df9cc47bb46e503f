// SPDX-License-Identifier: MIT
#include "precompute/overlap_in_plane.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace relume {
namespace {

using Corners = std::array<glm::vec3, 3>;
using FlatCorners = std::array<glm::dvec2, 3>;

struct Range {
  double lower, upper;
};

template <class Distance>
Range range_of(const Distance& distance) {
  const double a = distance(0), b = distance(1), c = distance(2);
  return {std::min({a, b, c}), std::max({a, b, c})};
}

/// Not unit: twice the area.
glm::dvec3 cross_of(const Corners& t) {
  return glm::cross(glm::dvec3(t[1]) - glm::dvec3(t[0]), glm::dvec3(t[2]) - glm::dvec3(t[0]));
}

/// Without the coordinate along which the normal is longest.
FlatCorners flattened(const Corners& t, const glm::dvec3& normal) {
  const glm::dvec3 size = glm::abs(normal);
  const int dropped = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  FlatCorners flat;
  for (std::size_t k = 0; k < 3; ++k) flat[k] = {t[k][(dropped + 1) % 3], t[k][(dropped + 2) % 3]};
  return flat;
}

/// Whether a line along an edge of `a` parts them, all but `tolerance`.
bool edge_parts(const FlatCorners& a, const FlatCorners& b, double tolerance) {
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec2 edge = a[(k + 1) % 3] - a[k];
    const double length = glm::length(edge);
    if (!(length > 0.0)) continue;
    const glm::dvec2 across = glm::dvec2(-edge.y, edge.x) / length;
    const Range own = range_of([&](std::size_t i) { return glm::dot(across, a[i] - a[k]); });
    const Range other = range_of([&](std::size_t i) { return glm::dot(across, b[i] - a[k]); });
    if (other.upper <= own.lower + tolerance || own.upper <= other.lower + tolerance) return true;
  }
  return false;
}

}  // namespace

bool overlap_in_plane(const Corners& a, const Corners& b, float largest) {
  const glm::dvec3 cross_a = cross_of(a), cross_b = cross_of(b);
  const double squared_a = glm::dot(cross_a, cross_a), squared_b = glm::dot(cross_b, cross_b);
  const double along = glm::dot(cross_a, cross_b);
  constexpr double kParallel = 1.0 - 1e-6;
  if (!(along * along > kParallel * squared_a * squared_b)) return false;
  const double length = std::sqrt(squared_a);
  const Range height = range_of(
      [&](std::size_t i) { return glm::dot(cross_a, glm::dvec3(b[i]) - glm::dvec3(a[0])) / length; });
  const double same_plane = double(largest) * 0x1p-20, apart = double(largest) * 0x1p-18;
  if (!(height.lower <= same_plane && height.upper >= -same_plane)) return false;
  const FlatCorners flat_a = flattened(a, cross_a), flat_b = flattened(b, cross_a);
  return !edge_parts(flat_a, flat_b, apart) && !edge_parts(flat_b, flat_a, apart);
}

}  // namespace relume
