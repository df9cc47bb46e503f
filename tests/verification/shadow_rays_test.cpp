// SPDX-License-Identifier: MIT
//
// Shadow rays of the device against Embree's, from the sample points of every shared scene. Only rays within
// rounding of an edge may differ.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "compute/device_fixture.h"
#include "compute/standalone/light_session.h"
#include "core/light_patches.h"
#include "core/ray_offset.h"
#include "precompute/direct_irradiance.h"
#include "precompute/precompute.h"
#include "precompute/ray_caster.h"
#include "scene/load_scene.h"
#include "scene/shared_files.h"

namespace relume::test {
namespace {

constexpr double kLumels = 400.0;

double area_of_scene(const Scene& scene) {
  double area = 0.0;
  for (const auto& t : scene.triangles) {
    const auto& p = scene.vertices.positions;
    area += 0.5 * glm::length(glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
  }
  return area;
}

/// The lights that the scene came with, or the rig's, and a sun. Up to five.
std::vector<Light> lights_of(const Model& model) {
  std::vector<Light> lights = model.lights;
  lights.resize(std::min<std::size_t>(lights.size(), 4));
  Light sun;
  sun.type = LightType::directional;
  sun.intensity = Rgb(1000.0);
  sun.direction = glm::normalize(glm::dvec3(-0.4, -1.0, -0.3));
  lights.push_back(sun);
  return lights;
}

/// From each sample point towards each light that it faces.
std::vector<LightSegment> shadow_rays(const Model& model, const std::vector<Light>& lights) {
  const float offset = ray_offset(model.occluders.positions);
  glm::vec3 lower(0.0f), upper(0.0f);
  for (const glm::vec3& p : model.occluders.positions) lower = glm::min(lower, p), upper = glm::max(upper, p);
  std::vector<LightSegment> rays;
  for (const System& system : model.systems) {
    for (const SurfaceElement& element : system.elements) {
      for (const LightPatch& patch : element_patches(model, system, element)) {
        const glm::vec3 from = glm::vec3(patch_point(patch)) + glm::vec3(patch.normal) * offset;
        for (const Light& light : lights) {
          const bool directional = light.type == LightType::directional;
          const glm::dvec3 way = directional ? -2.0 * double(glm::length(upper - lower)) * light.direction
                                             : light.position - model.origin - glm::dvec3(from);
          if (glm::dot(way, patch.normal) <= 0.0) continue;
          const double gap = directional ? 0.0 : 4.0 * double(offset) / glm::length(way);
          if (gap < 1.0) rays.push_back({from, from + glm::vec3(way * (1.0 - gap))});
        }
      }
    }
  }
  return rays;
}

struct Count {
  std::size_t rays = 0;
  std::size_t differ = 0;
  std::size_t dark = 0;
};

class ShadowRays : public DeviceTest {
 protected:
  Count compare_rays(const Model& model) {
    const auto& occluders = model.occluders;
    const auto caster = RayCaster::create(occluders.positions, occluders.triangles, occluders.opacity);
    auto session = LightSession::create(device(), model);
    EXPECT_TRUE(caster && session);
    const std::vector<LightSegment> rays = shadow_rays(model, lights_of(model));
    const auto shares = session->trace(rays);
    EXPECT_TRUE(shares) << shares.error().message;
    Count count{rays.size(), 0, 0};
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const float expected = caster->transmittance(rays[i].from, rays[i].to);
      if (std::abs(expected - (*shares)[i]) > 1e-4f) ++count.differ;
      if (expected == 0.0f) ++count.dark;
    }
    return count;
  }

  /// Mean over all clusters of how far H is off, as a share of its mean.
  double compare_light(const Model& model) {
    const std::vector<Light> lights = lights_of(model);
    const auto expected = direct_irradiance(model, lights);
    const auto found = direct_light_on_device(device(), model, lights);
    EXPECT_TRUE(expected && found);
    double off = 0.0, whole = 0.0;
    for (std::size_t i = 0; i < expected->clusters.size(); ++i) {
      off += std::abs(expected->clusters[i].r - found->clusters[i].r);
      whole += expected->clusters[i].r;
    }
    return whole > 0.0 ? off / whole : off;
  }
};

TEST_F(ShadowRays, OfSharedScenesAreThoseOfEmbree) {
  const auto shared = shared_files();
  if (!shared) GTEST_SKIP() << "no shared scenes";
  for (const char* file :
       {"scenes/babylon_cornellBox.glb", "scenes/cave/cave.gltf", "scenes/garage/garage.gltf",
        "scenes/godot_room.glb", "scenes/godot_town.glb", "scenes/hotel_room.glb", "scenes/institute.glb",
        "scenes/japanese_bridge_garden.glb", "scenes/kaykit_dungeon.glb", "scenes/living_room.glb",
        "scenes/pc_house.glb", "scenes/tile-game-room6.glb", "scenes/turbine.glb", "scenes/webxr_hall.glb",
        "truth/room_A.glb"}) {
    const auto scene = load_scene(*shared / file);
    ASSERT_TRUE(scene) << file << ": " << scene.error().message;
    PrecomputeOptions options;
    options.texel_size = std::sqrt(area_of_scene(*scene) / kLumels);
    options.cluster_size = 3.0 * options.texel_size;
    options.quality = 8;
    PrecomputeReport report;
    const auto model = precompute(*scene, options, report);
    ASSERT_TRUE(model) << file << ": " << model.error().message;
    const auto checked = check_model(*model);
    ASSERT_TRUE(checked) << file << ": " << checked.error().message;
    const Count count = compare_rays(*model);
    const double off = compare_light(*model);
    std::printf("%-40s %7zu rays, %4.1f %% in the dark, %zu differ, H off by %.1e\n", file, count.rays,
                100.0 * double(count.dark) / double(count.rays), count.differ, off);
    EXPECT_GT(count.rays, 1000u) << file;
    EXPECT_LT(double(count.differ), 1e-3 * double(count.rays)) << file;
    EXPECT_LT(off, 1e-3) << file;
  }
}

}  // namespace
}  // namespace relume::test
