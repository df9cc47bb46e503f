// SPDX-License-Identifier: MIT
//
// The whole path against plain path tracing: two rooms with boxes, lamps and coloured walls, and again after
// the lights and colours have changed, on the same precompute.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "verification/path_tracer.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

using P = glm::dvec3;

/// Whether a point of the floor or the side walls lies under a crate or within the dividing wall.
bool covered(const P& p) {
  for (const Footprint& f : two_rooms_footprints()) {
    if (p.y < 0.01 && p.x > f.x0 && p.x < f.x1 && p.z > f.z0 && p.z < f.z1) return true;
  }
  const bool in_doorway = p.z > 1.0 && p.z < 1.9 && p.y < 2.0;
  return p.x > 4.0 && p.x < 4.1 && !in_doorway;
}

/// Random points 1 mm above all surfaces, by area, two per triangle at least.
std::vector<SurfacePoint3> points_on_surfaces(const Scene& scene, double per_square_metre) {
  std::mt19937_64 random(5);
  const auto uniform = [&] { return double(random() >> 11) * 0x1p-53; };
  std::vector<SurfacePoint3> points;
  for (const auto& t : scene.triangles) {
    const P a = scene.vertices.positions[t[0]], e1 = scene.vertices.positions[t[1]] - a,
            e2 = scene.vertices.positions[t[2]] - a, cross = glm::cross(e1, e2);
    const auto count = std::max(2l, std::lround(per_square_metre * 0.5 * glm::length(cross)));
    for (long i = 0; i < count; ++i) {
      const double root = std::sqrt(uniform()), v = uniform();
      const P p = a + root * (1.0 - v) * e1 + root * v * e2;
      if (!covered(p)) points.push_back({p + 1e-3 * glm::normalize(cross), glm::normalize(cross)});
    }
  }
  return points;
}

std::vector<Light> other_lights() {
  Light bulb;
  bulb.intensity = {8.0, 6.0, 4.0};
  bulb.position = {3.2, 1.7, 0.8};
  Light spot;
  spot.type = LightType::spot;
  spot.intensity = {60.0, 60.0, 80.0};
  spot.position = {6.5, 2.3, 1.0};
  spot.direction = glm::normalize(P(-0.4, -1.0, 0.3));
  spot.inner_cone_angle = 0.3;
  spot.outer_cone_angle = 0.6;
  return {bulb, spot};
}

class TwoRooms : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    points_ = points_on_surfaces(two_rooms(), 1.9);
    PrecomputeOptions options;
    options.cluster_size = 0.2;
    options.texel_size = 0.1;
    options.quality = 512;
    for (const SurfacePoint3& p : points_) options.sensors.push_back({"s", p.position, p.normal});
    model_ = precompute_or_throw(two_rooms(), options);
  }
  static void TearDownTestSuite() { model_ = {}; }

  /// Everything but the precompute, with the colours of `scene`.
  static void expect_path_traced_irradiance(const Scene& scene, const std::vector<Light>& lights) {
    ASSERT_GE(points_.size(), 200u);
    const GatheredIrradiance gathered = solve_and_gather(model_, light(model_, scene, {lights, {}}));
    const auto direct = at_sensors(model_, gathered.direct), indirect = at_sensors(model_, gathered.indirect);
    const PathTracer tracer(scene, lights);
    const auto estimates = tracer.indirect(points_, {16, 256, 1});
    std::vector<Rgb> expected, expected_total, total;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      expected.push_back(estimates[i].mean);
      expected_total.push_back(estimates[i].mean + tracer.direct(points_[i]));
      total.push_back(direct[i] + indirect[i]);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(direct[i][c], tracer.direct(points_[i])[c], 1e-3 * tracer.direct(points_[i])[c]);
    }
    for (const Agreement& a : {agreement(indirect, expected), agreement(total, expected_total)}) {
      EXPECT_LE(std::abs(a.bias), 0.005);
      EXPECT_LE(a.nrmse, 0.02);
    }
    RecordProperty("bias", std::to_string(agreement(indirect, expected).bias));
    RecordProperty("nrmse", std::to_string(agreement(indirect, expected).nrmse));
  }

  static inline std::vector<SurfacePoint3> points_;
  static inline Model model_;
};

TEST_F(TwoRooms, AgreeWithPathTracing) {
  expect_path_traced_irradiance(two_rooms(), {});
}

TEST_F(TwoRooms, AgreeWithPathTracingAfterLightsAndColoursChanged) {
  expect_path_traced_irradiance(two_rooms_recoloured(), other_lights());
}

}  // namespace
}  // namespace relume::test
