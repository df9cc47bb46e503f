// SPDX-License-Identifier: MIT
#include "precompute/opacity.h"

#include <bit>
#include <set>

#include "precompute/clip_grid.h"
#include "precompute/sampling.h"

namespace relume {
namespace {

/// Parts that cover more texels are sampled at so many points.
constexpr double kMaxExactTexels = 1024.0;
constexpr std::uint32_t kOpacitySamples = 1024;

std::uint64_t bits(float a, float b) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(a)} << 32 | std::bit_cast<std::uint32_t>(b);
}

std::uint64_t position_key(const glm::vec3& p) {
  // Zero has two signs, and is one place.
  return mix(mix(bits(p.x + 0.0f, p.y + 0.0f)), bits(p.z + 0.0f, 0.0f));
}

glm::vec2 at_corner(const std::array<glm::vec2, 3>& corners, const glm::dvec2& b) {
  return glm::vec2(glm::dvec2(corners[0]) * (1.0 - b.x - b.y) + glm::dvec2(corners[1]) * b.x +
                   glm::dvec2(corners[2]) * b.y);
}

/// The corners of a part in texels, about a texel nearby (far-out coordinates would not fit the grid's
/// integers), carrying their barycentric coordinates in that part.
GridPolygon in_texels(const OpacityMap& map, const OpacityTriangle& listed,
                      const std::array<glm::vec2, 3>& corners) {
  constexpr std::array<glm::dvec2, 3> kOwn{glm::dvec2{0, 0}, glm::dvec2{1, 0}, glm::dvec2{0, 1}};
  std::array<glm::dvec2, 3> at;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 point = listed.corners[0] + corners[k].x * (listed.corners[1] - listed.corners[0]) +
                            corners[k].y * (listed.corners[2] - listed.corners[0]);
    at[k] = glm::dvec2(point.x, point.y) * glm::dvec2(map.width, map.height);
  }
  const glm::dvec2 origin = glm::floor(at[0]);
  GridPolygon polygon;
  for (std::size_t k = 0; k < 3; ++k) polygon.push({at[k] - origin, kOwn[k]});
  return polygon;
}

double texels_between(const GridPolygon& polygon) {
  double count = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    double lower = polygon[0].position[axis], upper = lower;
    for (std::size_t k = 1; k < 3; ++k) {
      lower = std::min(lower, polygon[k].position[axis]);
      upper = std::max(upper, polygon[k].position[axis]);
    }
    count *= upper - lower + 1.0;
  }
  return count;
}

glm::dvec2 middle(const GridPolygon& polygon) {
  glm::dvec2 sum(0.0);
  for (std::size_t k = 0; k < polygon.size(); ++k) sum += polygon[k].barycentric;
  return sum / double(polygon.size());
}

}  // namespace

std::uint64_t ray_key(const glm::vec3& origin, const glm::vec3& direction) {
  return mix(mix(mix(bits(origin.x, origin.y)), bits(origin.z, direction.x)), bits(direction.y, direction.z));
}

TriangleOpacity::TriangleOpacity(Opacity opacity, std::span<const glm::vec3> positions,
                                 std::span<const std::array<std::uint32_t, 3>> triangles)
    : opacity_(std::move(opacity)) {
  if (opacity_.triangles.empty()) return;
  entry_.assign(triangles.size(), kNone);
  std::set<std::uint64_t> seen;
  for (std::uint32_t i = 0; i < opacity_.triangles.size(); ++i) {
    const std::uint32_t triangle = opacity_.triangles[i].triangle;
    entry_[triangle] = i;
    std::uint64_t key = 0;
    for (const auto corner : triangles[triangle]) key += position_key(positions[corner]);
    sheet_.push_back(key);
    repeats_.push_back(!seen.insert(key).second);
  }
}

double TriangleOpacity::mean(std::uint32_t triangle, const std::array<glm::vec2, 3>& corners) const {
  if (opaque(triangle)) return 1.0;
  const OpacityTriangle& listed = opacity_.triangles[entry_[triangle]];
  const OpacityMap& map = opacity_.maps[listed.map];
  const auto opacity_in_part = [&](const glm::dvec2& b) {
    const glm::vec2 uv = at_corner(corners, b);
    return double(opacity_at(opacity_, listed, uv.x, uv.y));
  };
  const auto& c = listed.corners;
  const bool even = c[0].z == c[1].z && c[0].z == c[2].z;
  if (map.width == 0 && even) return opacity_in_part(glm::dvec2(1.0 / 3.0));
  const GridPolygon polygon = in_texels(map, listed, corners);
  const double whole = area(polygon);
  double sum = 0.0;
  if (even && whole > 0.0 && texels_between(polygon) <= kMaxExactTexels) {
    for_each_cell(polygon, [&](int, int, const GridPolygon& part) {
      sum += area(part) / whole * opacity_in_part(middle(part));
    });
    return std::min(sum, 1.0);
  }
  static const SobolPoints points(kOpacitySamples);
  for (std::uint32_t i = 0; i < kOpacitySamples; ++i) {
    const SamplePoint s = points.scrambled(i, 0);
    sum += opacity_in_part(glm::dvec2(triangle_point(s[0], s[1]))) / kOpacitySamples;
  }
  return sum;
}

bool TriangleOpacity::passes(std::uint32_t triangle, float u, float v, std::uint64_t key) const {
  const float opacity = at(triangle, u, v);
  if (opacity <= 0.0f || opacity >= 1.0f) return opacity <= 0.0f;
  return float(mix(key, sheet_[entry_[triangle]]) >> 40) * 0x1p-24f >= opacity;
}

}  // namespace relume
