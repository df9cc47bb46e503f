// SPDX-License-Identifier: MIT
#include "precompute/lift_sensor.h"

#include <gtest/gtest.h>

#include <random>

#include "support/scene_builder.h"

namespace relume {
namespace {

/// A room of 6 m, turned about two axes so that no face is aligned, away from the origin.
Scene turned_room() {
  test::SceneBuilder builder;
  builder.add_room("room", builder.material("paint", Rgb(0.5)), {-3, -3, -3}, {3, 3, 3});
  Scene scene = builder.scene();
  for (glm::dvec3& p : scene.vertices.positions) {
    p = {0.6 * p.x - 0.8 * p.y, 0.8 * p.x + 0.6 * p.y, p.z};
    p = glm::dvec3(p.x, 0.28 * p.y - 0.96 * p.z, 0.96 * p.y + 0.28 * p.z) + glm::dvec3(10, -4, 7);
  }
  return scene;
}

TEST(LiftSensor, LiftsWhatLiesOnASurfaceOrJustUnderIt) {
  const Scene scene = turned_room();
  const Geometry geometry = make_geometry(scene);
  const auto caster = make_caster(geometry);
  ASSERT_TRUE(caster);
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(0.05, 0.9);
  for (int trial = 0; trial < 2000; ++trial) {
    const auto triangle = static_cast<std::uint32_t>(random() % geometry.triangles.size());
    const double u = unit(random) * 0.5;
    const double v = unit(random) * 0.5;
    const auto& t = scene.triangles[triangle];
    const auto& p = scene.vertices.positions;
    const glm::dvec3 on = p[t[0]] * (1.0 - u - v) + p[t[1]] * u + p[t[2]] * v;
    const glm::dvec3 normal(geometry.normals[triangle]);
    for (const double depth : {0.0, 1e-6, 5e-4}) {
      const SurfacePoint at = lift_sensor(geometry, *caster, on - depth * normal, normal);
      const double height = glm::dot(glm::dvec3(at.position) - on, normal);
      // At the offset, give or take the rounding of coordinates of 15 m to 32 bits.
      EXPECT_NEAR(height, static_cast<double>(geometry.offset), 4e-6) << depth;
      EXPECT_FALSE(caster->occluded(at.position, glm::vec3(10, -4, 7))) << "it sees the middle of the room";
    }
  }
}

TEST(LiftSensor, LeavesWhatIsInFreeSpace) {
  const Geometry geometry = make_geometry(turned_room());
  const auto caster = make_caster(geometry);
  ASSERT_TRUE(caster);
  const SurfacePoint at = lift_sensor(geometry, *caster, {10.5, -4, 7}, {0, 2, 0});
  EXPECT_EQ(at.position, glm::vec3(10.5f, -4.0f, 7.0f));
  EXPECT_EQ(at.normal, glm::vec3(0.0f, 1.0f, 0.0f));
}

}  // namespace
}  // namespace relume
