// SPDX-License-Identifier: MIT
#include "precompute/rig.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/scene_builder.h"

namespace relume {
namespace {

using test::SceneBuilder;

Model lit(const Scene& scene, std::vector<std::string>& warnings) {
  const Geometry geometry = make_geometry(scene);
  const auto caster = make_caster(geometry);
  Model model;
  light_model(scene, geometry, *caster, nullptr, model, warnings);
  return model;
}

TEST(Rig, OneLampUnderTheCeilingOfARoom) {
  SceneBuilder builder;
  builder.add_room("room", builder.material("m", Rgb(0.5)), {0, 0, 0}, {4, 2.5, 6});
  std::vector<std::string> warnings;
  const Model model = lit(builder.scene(), warnings);
  ASSERT_EQ(model.lights.size(), 1u);
  EXPECT_TRUE(model.lit_by_rig);
  EXPECT_EQ(model.lights[0].intensity, Rgb(1000.0));
  EXPECT_NEAR(model.lights[0].position.y, 2.2, 1e-4);
  EXPECT_NEAR(model.lights[0].position.x, 2.0, 0.3);
  EXPECT_NEAR(model.lights[0].position.z, 3.0, 0.3);
  EXPECT_EQ(warnings.size(), 1u);
}

TEST(Rig, EachOfTwoSealedRoomsHasALamp) {
  SceneBuilder builder;
  const auto m = builder.material("m", Rgb(0.5));
  builder.add_room("a", m, {0, 0, 0}, {3, 2.5, 3});
  builder.add_room("b", m, {3.1, 0, 0}, {7, 2.5, 3});
  std::vector<std::string> warnings;
  const Model model = lit(builder.scene(), warnings);
  ASSERT_EQ(model.lights.size(), 2u);
  const auto in_a = [](const Light& l) { return l.position.x < 3.0; };
  EXPECT_EQ(std::count_if(model.lights.begin(), model.lights.end(), in_a), 1);
}

TEST(Rig, AnOpenSceneGetsSunAndSky) {
  SceneBuilder builder;
  builder.add_box("block", builder.material("m", Rgb(0.5)), {0, 0, 0}, {1, 1, 1},
                  SceneBuilder::Facing::outward);
  std::vector<std::string> warnings;
  const Model model = lit(builder.scene(), warnings);
  ASSERT_EQ(model.lights.size(), 1u);
  EXPECT_EQ(model.lights[0].type, LightType::directional);
  EXPECT_EQ(model.lights[0].intensity, Rgb(50000.0));
  EXPECT_LT(model.lights[0].direction.y, 0.0);
  ASSERT_TRUE(model.sky_radiance);
  EXPECT_EQ(*model.sky_radiance, Rgb(1000.0));
}

TEST(Rig, AnEmitterIsLightEnough) {
  SceneBuilder builder;
  builder.add_room("room", builder.material("m", Rgb(0.5), Rgb(1.0)), {0, 0, 0}, {4, 2.5, 6});
  std::vector<std::string> warnings;
  const Model model = lit(builder.scene(), warnings);
  EXPECT_TRUE(model.lights.empty());
  EXPECT_FALSE(model.lit_by_rig);
  EXPECT_TRUE(warnings.empty());
}

}  // namespace
}  // namespace relume
