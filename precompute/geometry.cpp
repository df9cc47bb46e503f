// SPDX-License-Identifier: MIT
#include "precompute/geometry.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "core/mix.h"
#include "core/ray_offset.h"
#include "precompute/key_index.h"
#include "scene/scene_opacity.h"
#include "scene/surface_color.h"

namespace relume {
namespace {

/// Beyond this ratio of distance to size, single precision about the world's origin would cost more than
/// 2^-14 of the scene's size.
constexpr double kFarOut = 256.0;

glm::dvec3 choose_origin(const Scene& scene) {
  if (scene.vertices.positions.empty()) return glm::dvec3(0.0);
  glm::dvec3 lower(std::numeric_limits<double>::max());
  glm::dvec3 upper(std::numeric_limits<double>::lowest());
  for (const auto& triangle : scene.triangles) {
    for (const auto corner : triangle) {
      lower = glm::min(lower, scene.vertices.positions[corner]);
      upper = glm::max(upper, scene.vertices.positions[corner]);
    }
  }
  const glm::dvec3 centre = 0.5 * (lower + upper);
  const double size = glm::length(upper - lower);
  if (scene.triangles.empty() || glm::length(centre) < kFarOut * size) return glm::dvec3(0.0);
  return glm::floor(centre);
}

void add_triangle_facts(const Scene& scene, Geometry& geometry) {
  const auto surfaces = surface_of_triangles(scene);
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t) {
    const auto& corners = geometry.triangles[t];
    const glm::dvec3 p0 = scene.vertices.positions[corners[0]];
    const glm::dvec3 cross =
        glm::cross(scene.vertices.positions[corners[1]] - p0, scene.vertices.positions[corners[2]] - p0);
    const double length = glm::length(cross);
    const SceneSurface& surface = scene.surfaces[surfaces[t]];
    geometry.surface.push_back(surfaces[t]);
    geometry.material.push_back(surface.material);
    geometry.node.push_back(surface.node);
    geometry.normals.push_back(length > 0.0 ? glm::vec3(cross / length) : glm::vec3(0.0f, 1.0f, 0.0f));
    geometry.areas.push_back(static_cast<float>(0.5 * length));
    geometry.area += 0.5 * length * (geometry.double_sided[surface.material] ? 2.0 : 1.0);
    for (const auto corner : corners) {
      geometry.lower = glm::min(geometry.lower, geometry.positions[corner]);
      geometry.upper = glm::max(geometry.upper, geometry.positions[corner]);
    }
  }
}

using Corners = std::array<glm::vec3, 3>;

Corners corners_of(const Geometry& geometry, std::uint32_t triangle) {
  const auto& t = geometry.triangles[triangle];
  return {geometry.positions[t[0]], geometry.positions[t[1]], geometry.positions[t[2]]};
}

bool less(const glm::vec3& a, const glm::vec3& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (a[axis] != b[axis]) return a[axis] < b[axis];
  }
  return false;
}

std::uint64_t place_key(const glm::vec3& place) {
  const auto bits = std::bit_cast<std::array<std::uint32_t, 3>>(place + 0.0f);  // -0 and +0 are one place
  return mix(mix(0, std::uint64_t{bits[0]} << 32 | bits[1]), bits[2]);
}

/// Per triangle: the same for those that have the same corners, in whatever order.
std::vector<std::uint64_t> corner_keys(const Geometry& geometry) {
  std::vector<std::uint64_t> places(geometry.positions.size()), keys(geometry.triangles.size());
  std::transform(geometry.positions.begin(), geometry.positions.end(), places.begin(), place_key);
  std::transform(geometry.triangles.begin(), geometry.triangles.end(), keys.begin(),
                 [&](const auto& t) { return places[t[0]] + places[t[1]] + places[t[2]]; });
  return keys;
}

/// The corners from the smallest on, in the same sense.
Corners canonical(Corners corners) {
  std::size_t least = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (less(corners[k], corners[least])) least = k;
  }
  return {corners[least], corners[(least + 1) % 3], corners[(least + 2) % 3]};
}

std::vector<std::uint32_t> find_opposites(const Geometry& geometry) {
  const std::vector<std::uint64_t> keys = corner_keys(geometry);
  const KeyIndex index(keys);
  std::vector<std::uint32_t> opposite(geometry.triangles.size(), kNone);
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t) {
    std::uint32_t other = index.find(keys[t]);
    if (other == t) continue;
    const Corners own = canonical(corners_of(geometry, t)), reversed{own[0], own[2], own[1]};
    while (other < t && canonical(corners_of(geometry, other)) != reversed) other = index.after(other);
    if (other >= t || opposite[other] != kNone) continue;
    opposite[t] = other;
    opposite[other] = t;
  }
  return opposite;
}

/// Barycentric coordinates in `to` of a point given in `from`, which has the same corners in another order.
glm::vec2 reorder(const Corners& from, const Corners& to, float u, float v) {
  const std::array<float, 3> weights{1.0f - u - v, u, v};
  std::array<float, 3> result{};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (from[j] == to[k]) result[k] = weights[j];
    }
  }
  return {result[1], result[2]};
}

}  // namespace

std::optional<SurfaceHit> seen_surface(const Geometry& geometry, const SurfaceHit& met,
                                       const glm::vec3& direction) {
  SurfaceHit hit = met;
  hit.side = glm::dot(geometry.normals[met.triangle], direction) < 0.0f ? Side::front : Side::back;
  if (hit.side == Side::front || geometry.has_back(met.triangle)) return hit;
  const std::uint32_t other = geometry.opposite[met.triangle];
  if (other == kNone) return std::nullopt;
  const glm::vec2 uv = reorder(corners_of(geometry, met.triangle), corners_of(geometry, other), met.u, met.v);
  return SurfaceHit{other, uv.x, uv.y, Side::front};
}

Geometry make_geometry(const Scene& scene) {
  Geometry geometry;
  geometry.origin = choose_origin(scene);
  geometry.positions.reserve(scene.vertices.positions.size());
  for (const glm::dvec3& p : scene.vertices.positions) geometry.positions.emplace_back(p - geometry.origin);
  geometry.triangles = scene.triangles;
  for (const SceneMaterial& material : scene.materials)
    geometry.double_sided.push_back(material.double_sided);
  if (!geometry.triangles.empty()) {
    geometry.lower = geometry.upper = geometry.positions[geometry.triangles[0][0]];
  }
  add_triangle_facts(scene, geometry);
  geometry.opposite = find_opposites(geometry);
  geometry.opacity = TriangleOpacity(scene_opacity(scene), geometry.positions, geometry.triangles);
  geometry.offset = ray_offset(geometry.positions);
  return geometry;
}

}  // namespace relume
