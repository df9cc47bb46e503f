// SPDX-License-Identifier: MIT
#include "precompute/light_samples.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "core/light_patches.h"
#include "core/ray_offset.h"
#include "precompute/embree_bvh.h"
#include "precompute/lift_sensor.h"
#include "precompute/views.h"

namespace relume {
namespace {

/// Of one element.
struct OwnPatches {
  std::size_t count = 0;  ///< patches
  std::vector<bool> own;  ///< of each; empty: all are
};

/// Of an element that may have patches behind walls; empty where all are its own. Then none of the answers is
/// kept: it will be known that they were.
std::vector<bool> ask_patches(const SurfaceElement& element, const std::vector<LightPatch>& patches,
                              Views& views) {
  const SurfacePoint middle{element.position, element.normal};
  std::vector<SurfacePoint> points;
  for (const LightPatch& patch : patches)
    points.push_back({glm::vec3(patch_point(patch)), glm::vec3(patch.normal)});
  std::uint64_t rays = 0;
  std::vector<bool> own = views.ask_each(middle, points, rays);
  if (std::all_of(own.begin(), own.end(), [](bool owned) { return owned; })) return {};
  for (std::size_t p = 0; p < points.size(); ++p) views.keep(middle, points[p], own[p]);
  return own;
}

std::vector<OwnPatches> find_own_patches(const Model& model, const System& system, Views& views,
                                         std::vector<std::uint8_t>& whole) {
  std::vector<OwnPatches> patches(system.elements.size());
  whole.resize(patches.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, patches.size(), 64), [&](const auto& range) {
    for (std::size_t e = range.begin(); e < range.end(); ++e) {
      const SurfaceElement& element = system.elements[e];
      patches[e].count = count_element_patches(model, system, element);
      if (whole[e] == 0)
        patches[e].own = ask_patches(element, element_patches(model, system, element), views);
      whole[e] = patches[e].own.empty() ? 1 : 0;
    }
  });
  return patches;
}

/// Empty where all belong.
std::vector<std::uint32_t> as_bits(const std::vector<OwnPatches>& patches) {
  std::size_t count = 0;
  for (const OwnPatches& element : patches) count += element.count;
  std::vector<std::uint32_t> words((count + 31) / 32, 0xffffffffu);
  if (count % 32 != 0) words.back() >>= 32 - count % 32;
  bool all = true;
  std::size_t first = 0;
  for (const OwnPatches& element : patches) {
    for (std::size_t p = 0; p < element.own.size(); ++p) {
      if (!element.own[p]) words[(first + p) / 32] &= ~(1u << (first + p) % 32);
      all = all && element.own[p];
    }
    first += element.count;
  }
  return all ? std::vector<std::uint32_t>() : words;
}

}  // namespace

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

void add_light_samples(const Geometry& geometry, const RayCaster& caster, Model& model, Views& views,
                       WholeElements& whole) {
  whole.resize(model.systems.size());
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    System& system = model.systems[s];
    system.own_patches = as_bits(find_own_patches(model, system, views, whole[s]));
    system.lifted_sensors.clear();
    for (const Sensor& sensor : system.sensors) {
      system.lifted_sensors.push_back(
          lift_sensor(geometry, caster, sensor.position, glm::dvec3(sensor.normal)).position);
    }
  }
}

Result<void> add_light_samples(Model& model) {
  const auto caster =
      RayCaster::create(model.occluders.positions, model.occluders.triangles, model.occluders.opacity);
  if (!caster) return tl::unexpected(caster.error());
  Occluders& occluders = model.occluders;
  auto bvh = build_occluder_bvh(occluders.positions, occluders.triangles, occluders.opacity);
  if (!bvh) return tl::unexpected(bvh.error());
  occluders.bvh = std::move(*bvh);
  const Geometry geometry = occluder_geometry(model);
  Views views(geometry, *caster);
  WholeElements whole;
  add_light_samples(geometry, *caster, model, views, whole);
  return {};
}

}  // namespace relume
