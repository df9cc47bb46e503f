// SPDX-License-Identifier: MIT
#include "precompute/geometry.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "precompute/ray_offset.h"
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

}  // namespace

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
  geometry.offset = ray_offset(geometry.positions);
  return geometry;
}

}  // namespace relume
