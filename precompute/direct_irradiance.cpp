// SPDX-License-Identifier: MIT
#include "precompute/direct_irradiance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <new>

#include "precompute/arena_threads.h"
#include "precompute/lift_sensor.h"
#include "precompute/mutual_visibility.h"
#include "precompute/punctual_light.h"
#include "precompute/ray_offset.h"
#include "precompute/sampling.h"

namespace relume {
namespace {

/// Each element is cut into about so many patches, each with a shadow ray of its own from a random point.
constexpr double kPatchesPerElement = 16.0;
constexpr int kMaxPatchRows = 4;
/// Patches that look larger than this from a light (sr), or than a 64th of a spot's cone, are cut again, so
/// that shadows and cones close to a light are met.
constexpr double kMaxSolidAngle = 4.0 * kPi / 1024.0;
constexpr int kMaxCuts = 5;

/// What all elements share: occluders, and lights about their origin.
struct Surroundings {
  const Model& model;
  const RayCaster& caster;
  Geometry geometry;  ///< origin, positions, triangles, normals, bounds and offset only
  std::vector<Light> lights;
  float far = 0.0f;  ///< m, beyond everything
};

/// A triangle cut out of the surface, about the origin of the model.
struct Patch {
  TriangleCorners corners;
  glm::vec3 normal{0.0f};  ///< towards the receiving side
  std::uint64_t key = 0;   ///< of its random point
};

Geometry occluder_geometry(const Model& model) {
  Geometry geometry;
  geometry.origin = model.origin;
  geometry.positions = model.occluders.positions;
  geometry.triangles = model.occluders.triangles;
  geometry.offset = ray_offset(geometry.positions);
  if (!geometry.triangles.empty())
    geometry.lower = geometry.upper = geometry.positions[geometry.triangles[0][0]];
  for (const auto& triangle : geometry.triangles) {
    const glm::dvec3 p0 = geometry.positions[triangle[0]];
    const glm::dvec3 cross = glm::cross(glm::dvec3(geometry.positions[triangle[1]]) - p0,
                                        glm::dvec3(geometry.positions[triangle[2]]) - p0);
    const double length = glm::length(cross);
    geometry.normals.push_back(length > 0.0 ? glm::vec3(cross / length) : glm::vec3(0.0f, 1.0f, 0.0f));
    for (const auto corner : triangle) {
      geometry.lower = glm::min(geometry.lower, geometry.positions[corner]);
      geometry.upper = glm::max(geometry.upper, geometry.positions[corner]);
    }
  }
  return geometry;
}

Surroundings make_surroundings(const Model& model, const RayCaster& caster, std::span<const Light> lights) {
  Surroundings around{model, caster, occluder_geometry(model), {lights.begin(), lights.end()}};
  for (Light& light : around.lights) light.position -= model.origin;
  around.far = 2.0f * glm::length(around.geometry.upper - around.geometry.lower);
  return around;
}

double area_of(const Patch& patch) {
  return 0.5 *
         glm::length(glm::cross(patch.corners[1] - patch.corners[0], patch.corners[2] - patch.corners[0]));
}

/// A random point of the patch, the same at each call.
glm::dvec3 point_of(const Patch& patch) {
  const std::uint64_t bits = mix(patch.key);
  const auto to_unit = [](std::uint64_t value) { return static_cast<float>(value & 0xffffffu) * 0x1p-24f; };
  const glm::vec2 at = triangle_point(to_unit(bits), to_unit(bits >> 24));
  return patch.corners[0] * static_cast<double>(1.0f - at.x - at.y) +
         patch.corners[1] * static_cast<double>(at.x) + patch.corners[2] * static_cast<double>(at.y);
}

/// The four halves-of-edges children.
std::array<Patch, 4> cut_in_four(const Patch& patch) {
  const auto& [a, b, c] = patch.corners;
  const glm::dvec3 ab = 0.5 * (a + b);
  const glm::dvec3 bc = 0.5 * (b + c);
  const glm::dvec3 ca = 0.5 * (c + a);
  const auto child = [&patch](std::uint64_t index, const TriangleCorners& corners) {
    return Patch{corners, patch.normal, mix(patch.key, index + 1)};
  };
  return {child(0, {a, ab, ca}), child(1, {ab, b, bc}), child(2, {ca, bc, c}), child(3, {bc, ca, ab})};
}

double max_solid_angle(const Light& light) {
  if (light.type != LightType::spot) return kMaxSolidAngle;
  return std::min(kMaxSolidAngle, 2.0 * kPi * (1.0 - std::cos(light.outer_cone_angle)) / 64.0);
}

/// The share of the light from `light` (about the origin) that reaches a surface point.
double lit_share(const Surroundings& around, const Light& light, const SurfacePoint& point) {
  const glm::vec3 from = point.position + point.normal * around.geometry.offset;
  if (light.type == LightType::directional) {
    return around.caster.transmittance(from, from - glm::vec3(light.direction) * around.far);
  }
  // The ray ends just before the light: a lamp on a surface is not blocked by it.
  const glm::dvec3 way = light.position - glm::dvec3(from);
  const double distance = glm::length(way);
  const double gap = 4.0 * static_cast<double>(around.geometry.offset);
  if (distance <= gap) return 1.0;
  return around.caster.transmittance(from, from + glm::vec3(way * (1.0 - gap / distance)));
}

/// Whatever system it is in, the same place has the same random points.
std::uint64_t key_of(const SurfaceElement& element) {
  std::uint64_t key = 0;
  for (const glm::vec3& v : {element.position, element.normal}) {
    for (int k = 0; k < 3; ++k) key = mix(key, std::bit_cast<std::uint32_t>(v[k]));
  }
  return key;
}

/// One surface element while its light is added up.
class ElementLight {
 public:
  ElementLight(const Surroundings& around, const System& system, std::uint32_t element)
      : around_(around), element_(system.elements[element]) {
    const std::uint64_t key = key_of(element_);
    const Side side = system.clusters[element_.cluster].side;
    for (std::uint32_t p = 0; p < element_.piece_count; ++p) {
      add_patches(system.pieces[element_.first_piece + p], side, mix(key, p));
    }
    double area = 0.0;
    double owned = 0.0;
    for (const Patch& patch : patches_) {
      area += area_of(patch);
      if (owns({glm::vec3(point_of(patch)), patch.normal})) owned += area_of(patch);
    }
    guarded_ = owned < area;
    owned_area_ = owned;
  }

  /// Mean irradiance over the part that the element's middle sees (a piece that a wall runs through may reach
  /// beyond it).
  Rgb irradiance() const {
    if (owned_area_ <= 0.0) return Rgb(0.0);
    Rgb flux(0.0);
    for (const Light& light : around_.lights) {
      for (const Patch& patch : patches_) flux += light.intensity * flux_share(light, patch, 0);
    }
    return flux / owned_area_;
  }

 private:
  bool owns(const SurfacePoint& point) const {
    return mutually_visible(around_.geometry, around_.caster, {element_.position, element_.normal}, point);
  }

  /// The piece as rows of congruent triangles.
  void add_patches(const SurfacePiece& piece, Side side, std::uint64_t key) {
    const auto& corners = around_.geometry.triangles[piece.triangle];
    const glm::dvec3 p0 = around_.geometry.positions[corners[0]];
    const glm::dvec3 edge_u = glm::dvec3(around_.geometry.positions[corners[1]]) - p0;
    const glm::dvec3 edge_v = glm::dvec3(around_.geometry.positions[corners[2]]) - p0;
    Patch whole;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec2 at(piece.corners[k]);
      whole.corners[k] = p0 + edge_u * at.x + edge_v * at.y;
    }
    whole.normal = around_.geometry.normals[piece.triangle] * (side == Side::front ? 1.0f : -1.0f);
    const double wanted = kPatchesPerElement * area_of(whole) / element_.area;
    const int rows = std::clamp(static_cast<int>(std::lround(std::sqrt(wanted))), 1, kMaxPatchRows);
    const glm::dvec3 a = whole.corners[0];
    const glm::dvec3 along = (whole.corners[1] - a) / static_cast<double>(rows);
    const glm::dvec3 across = (whole.corners[2] - a) / static_cast<double>(rows);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column + row < rows; ++column) {
        const glm::dvec3 corner = a + along * static_cast<double>(column) + across * static_cast<double>(row);
        push_patch({corner, corner + along, corner + across}, whole.normal, key);
        if (column + row + 1 == rows) continue;
        push_patch({corner + along + across, corner + across, corner + along}, whole.normal, key);
      }
    }
  }

  void push_patch(const TriangleCorners& corners, const glm::vec3& normal, std::uint64_t key) {
    patches_.push_back({corners, normal, mix(key, patches_.size() + 1)});
  }

  /// Flux that the patch receives from the light, over the light's intensity.
  double flux_share(const Light& light, const Patch& patch, int cuts) const {
    const bool directional = light.type == LightType::directional;
    const double facing = directional ? -glm::dot(light.direction, glm::dvec3(patch.normal))
                                      : glm::dot(light.position - patch.corners[0], glm::dvec3(patch.normal));
    if (facing <= 0.0 || !may_reach(light, patch.corners)) return 0.0;
    const double size = directional ? facing * area_of(patch) : solid_angle(light.position, patch.corners);
    if (!directional && cuts < kMaxCuts && size > max_solid_angle(light)) {
      double sum = 0.0;
      for (const Patch& child : cut_in_four(patch)) sum += flux_share(light, child, cuts + 1);
      return sum;
    }
    const SurfacePoint point{glm::vec3(point_of(patch)), patch.normal};
    const double share = directional ? 1.0 : intensity_share(light, glm::dvec3(point.position));
    if (share <= 0.0) return 0.0;
    const double arriving = lit_share(around_, light, point);
    return arriving <= 0.0 || (guarded_ && !owns(point)) ? 0.0 : size * share * arriving;
  }

  const Surroundings& around_;
  const SurfaceElement& element_;
  std::vector<Patch> patches_;
  bool guarded_ = false;
  double owned_area_ = 0.0;  ///< m2, what alpha cuts out included: the light that falls there counts as well
};

std::vector<Rgb> light_elements(const Surroundings& around, const System& system) {
  std::vector<Rgb> irradiance(system.elements.size(), Rgb(0.0));
  if (around.lights.empty()) return irradiance;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, system.elements.size(), 64), [&](const auto& range) {
    for (std::size_t e = range.begin(); e < range.end(); ++e) {
      irradiance[e] = ElementLight(around, system, static_cast<std::uint32_t>(e)).irradiance();
    }
  });
  return irradiance;
}

Rgb light_sensor(const Surroundings& around, const Sensor& sensor) {
  const SurfacePoint at =
      lift_sensor(around.geometry, around.caster, sensor.position, glm::dvec3(sensor.normal));
  Rgb irradiance(0.0);
  for (const Light& light : around.lights) {
    const Rgb unblocked = irradiance_at_point(light, glm::dvec3(at.position), glm::dvec3(at.normal));
    if (unblocked == Rgb(0.0)) continue;
    irradiance += unblocked * lit_share(around, light, {at.position, glm::vec3(0.0f)});
  }
  return irradiance;
}

void append_system(const Surroundings& around, const System& system, DirectIrradiance& result) {
  const std::vector<Rgb> elements = light_elements(around, system);
  for (const Cluster& cluster : system.clusters) {
    Rgb flux(0.0);
    double area = 0.0;
    for (std::uint32_t e = cluster.first_element; e < cluster.first_element + cluster.element_count; ++e) {
      flux += static_cast<double>(system.elements[e].area) * elements[e];
      area += system.elements[e].area;
    }
    result.clusters.push_back(flux / area);
  }
  for (const Lumel& lumel : system.lumels) result.gather.push_back(elements[lumel.element]);
  for (const Sensor& sensor : system.sensors) result.gather.push_back(light_sensor(around, sensor));
}

}  // namespace

Result<DirectIrradiance> direct_irradiance(const Model& model, std::span<const Light> lights,
                                           std::uint32_t threads) {
  try {
    const auto caster =
        RayCaster::create(model.occluders.positions, model.occluders.triangles, model.occluders.opacity);
    if (!caster) return tl::unexpected(caster.error());
    const Surroundings around = make_surroundings(model, *caster, lights);
    DirectIrradiance result;
    tbb::task_arena arena(arena_threads(threads));
    arena.execute([&] {
      for (const System& system : model.systems) append_system(around, system, result);
    });
    return result;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory,
                "direct irradiance: not enough memory for the occluders of the model");
  }
}

}  // namespace relume
