// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "precompute/opacity.h"
#include "precompute/ray_caster.h"
#include "scene/scene.h"

namespace relume {

/// The static triangles of a scene in single precision about an origin, and what the precompute asks of each.
struct Geometry {
  glm::dvec3 origin{0.0};  ///< zero unless the scene lies so far out that single precision would suffer
  std::vector<glm::vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> surface;   ///< per triangle: index into Scene::surfaces
  std::vector<std::uint32_t> material;  ///< per triangle
  std::vector<std::uint32_t> node;      ///< per triangle
  std::vector<glm::vec3> normals;       ///< per triangle, unit, of the front
  std::vector<float> areas;             ///< per triangle, m2
  std::vector<bool> double_sided;       ///< per material
  std::vector<bool>
      hollow;  ///< per triangle: its back bounds a hollow (find_hollows.h); empty: none was looked for
  TriangleOpacity opacity;
  std::vector<std::uint32_t>
      opposite;       ///< per triangle: the one that covers the same corners in the other sense, or kNone
  double area = 0.0;  ///< m2 of all receiving sides
  glm::vec3 lower{0.0f}, upper{0.0f};  ///< bounds
  float offset = 0.0f;                 ///< see ray_offset.h

  glm::vec3 point(std::uint32_t triangle, float u, float v) const {
    const auto& t = triangles[triangle];
    return positions[t[0]] * (1.0f - u - v) + positions[t[1]] * u + positions[t[2]] * v;
  }
  /// Whether the back of a triangle receives and sends light.
  bool has_back(std::uint32_t triangle) const {
    return double_sided[material[triangle]] && !(triangle < hollow.size() && hollow[triangle]);
  }
  glm::vec3 normal(std::uint32_t triangle, Side side) const {
    return side == Side::front ? normals[triangle] : -normals[triangle];
  }
};

Geometry make_geometry(const Scene& scene);

/// Rays among the triangles of `geometry`. `known_ties` as RayCaster::create takes them.
inline Result<RayCaster> make_caster(const Geometry& geometry,
                                     std::span<const std::uint8_t> known_ties = {}) {
  return RayCaster::create(geometry.positions, geometry.triangles, geometry.opacity.stored(), known_ties);
}

/// A point of a side of a surface.
struct SurfaceHit {
  std::uint32_t triangle = 0;
  float u = 0.0f, v = 0.0f;
  Side side = Side::front;
};

/// What a ray travelling along `direction` sees where it met a triangle, or nothing: the back of a
/// single-sided surface, or of one that bounds a hollow, is opaque and black. Two single-sided triangles back
/// to back are one sheet: the ray sees the one that faces it, whichever was met.
std::optional<SurfaceHit> seen_surface(const Geometry& geometry, const SurfaceHit& met,
                                       const glm::vec3& direction);

}  // namespace relume
