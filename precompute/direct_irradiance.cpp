// SPDX-License-Identifier: MIT
#include "precompute/direct_irradiance.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <new>

#include "core/light_patches.h"
#include "core/ray_offset.h"
#include "precompute/arena_threads.h"
#include "precompute/embree_memory.h"
#include "precompute/lift_sensor.h"
#include "precompute/light_samples.h"
#include "precompute/mutual_visibility.h"
#include "precompute/punctual_light.h"

namespace relume {
namespace {

/// What all elements share: occluders, and lights about their origin.
struct Surroundings {
  const Model& model;
  const RayCaster& caster;
  Geometry geometry;  ///< origin, positions, triangles, normals, bounds and offset only
  std::vector<Light> lights;
  double patches_per_element = kPatchesPerElement;
  float far = 0.0f;  ///< m, beyond everything
};

Surroundings make_surroundings(const Model& model, const RayCaster& caster, std::span<const Light> lights,
                               double patches_per_element) {
  Surroundings around{
      model, caster, occluder_geometry(model), {lights.begin(), lights.end()}, patches_per_element};
  for (Light& light : around.lights) light.position -= model.origin;
  around.far = 2.0f * glm::length(around.geometry.upper - around.geometry.lower);
  return around;
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

/// One surface element while its light is added up.
class ElementLight {
 public:
  /// `first_patch` is the number of its first patch in the system.
  ElementLight(const Surroundings& around, const System& system, const SurfaceElement& element,
               std::size_t first_patch)
      : around_(around) {
    const ElementPatches own =
        own_patches(around.model, system, element, first_patch, around.patches_per_element);
    for (const ElementPatches::Patch& patch : own.patches) {
      const ElementPatches::Piece& piece = own.pieces[patch.piece];
      patches_.push_back(patch_of_piece(piece.whole, piece.rows, patch.index));
      area_ += area_of(patches_.back().corners);
    }
    if (own.lost_some) max_cuts_ = 0;
  }

  /// Mean over the patches that belong to the element.
  Rgb irradiance() const {
    if (area_ <= 0.0) return Rgb(0.0);
    Rgb flux(0.0);
    for (const Light& light : around_.lights) {
      for (const LightPatch& patch : patches_) flux += light.intensity * flux_share(light, patch, 0);
    }
    return flux / area_;
  }

 private:
  /// Flux that the patch receives from the light, over the light's intensity.
  double flux_share(const Light& light, const LightPatch& patch, int cuts) const {
    const bool directional = light.type == LightType::directional;
    const double facing = directional ? -glm::dot(light.direction, patch.normal)
                                      : glm::dot(light.position - patch.corners[0], patch.normal);
    if (facing <= 0.0 || !may_reach(light, patch.corners)) return 0.0;
    const double size =
        directional ? facing * area_of(patch.corners) : solid_angle(light.position, patch.corners);
    if (!directional && cuts < max_cuts_ && size > max_patch_solid_angle(light)) {
      double sum = 0.0;
      for (std::uint32_t child = 0; child < 4; ++child)
        sum += flux_share(light, quarter_of_patch(patch, child), cuts + 1);
      return sum;
    }
    const SurfacePoint point{glm::vec3(patch_point(patch)), glm::vec3(patch.normal)};
    const double share = directional ? 1.0 : intensity_share(light, glm::dvec3(point.position));
    return share <= 0.0 ? 0.0 : size * share * lit_share(around_, light, point);
  }

  const Surroundings& around_;
  std::vector<LightPatch> patches_;
  int max_cuts_ = kMaxPatchCuts;
  double area_ = 0.0;  ///< m2, what alpha cuts out included: the light that falls there counts as well
};

/// Number of the first patch of each element.
std::vector<std::size_t> first_patches(const Model& model, const System& system) {
  std::vector<std::size_t> first;
  std::size_t next = 0;
  for (const SurfaceElement& element : system.elements) {
    first.push_back(next);
    next += system.own_patches.empty() ? 0 : element_patches(model, system, element).size();
  }
  return first;
}

std::vector<Rgb> light_elements(const Surroundings& around, const System& system) {
  std::vector<Rgb> irradiance(system.elements.size(), Rgb(0.0));
  if (around.lights.empty()) return irradiance;
  const std::vector<std::size_t> first = first_patches(around.model, system);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, system.elements.size(), 64), [&](const auto& range) {
    for (std::size_t e = range.begin(); e < range.end(); ++e)
      irradiance[e] = ElementLight(around, system, system.elements[e], first[e]).irradiance();
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
                                           std::uint32_t threads, double patches_per_element) {
  try {
    const auto caster =
        RayCaster::create(model.occluders.positions, model.occluders.triangles, model.occluders.opacity);
    if (!caster) return tl::unexpected(caster.error());
    const Surroundings around = make_surroundings(model, *caster, lights, patches_per_element);
    DirectIrradiance result;
    tbb::task_arena arena(arena_threads(threads));
    arena.execute([&] {
      for (const System& system : model.systems) append_system(around, system, result);
    });
    return result;
  } catch (const std::bad_alloc&) {
    return fail(
        ErrorCode::out_of_memory,
        fmt::format("direct irradiance: memory ran out: expected about {} MB more for the occluders of "
                    "the model, found less",
                    embree_memory(model.occluders.triangles.size()) >> 20));
  }
}

}  // namespace relume
