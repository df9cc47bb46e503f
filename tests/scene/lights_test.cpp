// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "scene/gltf_sketch.h"

namespace relume {
namespace {

using test::GltfSketch;
using test::Json;

/// One node with one light.
GltfSketch lit(Json light, Json node = Json::object()) {
  GltfSketch sketch;
  sketch.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({std::move(light)});
  sketch.json["extensionsUsed"] = {"KHR_lights_punctual"};
  node["extensions"]["KHR_lights_punctual"]["light"] = 0;
  sketch.json["nodes"] = Json::array({std::move(node)});
  sketch.json["scenes"][0]["nodes"] = {0};
  return sketch;
}

TEST(Lights, DefaultsOfAPointLight) {
  const Light light = test::load_good(lit({{"type", "point"}})).lights.at(0);
  EXPECT_EQ(light.type, LightType::point);
  EXPECT_EQ(light.intensity, Rgb(1.0));
  EXPECT_EQ(light.range, 0.0);
}

TEST(Lights, IntensityIsColourTimesIntensity) {
  const Light light =
      test::load_good(lit({{"type", "point"}, {"color", {0.5, 1.0, 0.25}}, {"intensity", 80}, {"range", 7}},
                          {{"translation", {1, 2, 3}}, {"name", "lamp"}}))
          .lights.at(0);
  EXPECT_EQ(light.intensity, Rgb(40.0, 80.0, 20.0));
  EXPECT_EQ(light.range, 7.0);
  EXPECT_EQ(light.position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(light.name, "lamp");
}

TEST(Lights, TheyShineAlongMinusZWhateverTheScale) {
  // A quarter turn around X takes -Z to +Y.
  const double half = std::sqrt(0.5);
  for (const Json& scale : {Json{1, 1, 1}, Json{5, 0.1, 3}, Json{-1, 1, 1}}) {
    const Light light =
        test::load_good(lit({{"type", "directional"}}, {{"rotation", {half, 0, 0, half}}, {"scale", scale}}))
            .lights.at(0);
    EXPECT_LT(glm::distance(light.direction, glm::dvec3(0, 1, 0)), 1e-12) << scale;
  }
}

TEST(Lights, SpotsHaveCones) {
  const Light said =
      test::load_good(lit({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.3}}}}))
          .lights.at(0);
  EXPECT_EQ(said.inner_cone_angle, 0.1);
  EXPECT_EQ(said.outer_cone_angle, 0.3);
  const Light unsaid = test::load_good(lit({{"type", "spot"}, {"spot", Json::object()}})).lights.at(0);
  EXPECT_EQ(unsaid.inner_cone_angle, 0.0);
  EXPECT_NEAR(unsaid.outer_cone_angle, kPi / 4.0, 1e-9);
}

TEST(Lights, AScaleOfZeroLeavesNoDirection) {
  const Scene scene =
      test::load_good(lit({{"type", "spot"}, {"spot", Json::object()}}, {{"scale", {0, 0, 0}}}));
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_TRUE(test::warns(scene, "was left out"));
  EXPECT_EQ(test::load_good(lit({{"type", "point"}}, {{"scale", {0, 0, 0}}})).lights.size(), 1u);
}

TEST(Lights, OneLightMayHangOnManyNodes) {
  GltfSketch sketch = lit({{"type", "point"}});
  sketch.json["nodes"].push_back(sketch.json["nodes"][0]);
  sketch.json["nodes"][1]["translation"] = {4, 0, 0};
  sketch.json["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = test::load_good(sketch);
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[1].position, glm::dvec3(4, 0, 0));
}

TEST(Lights, OutOfRangeNumbersAreRefused) {
  for (const Json& light :
       {Json{{"type", "point"}, {"intensity", -1}}, Json{{"type", "point"}, {"range", 0}},
        Json{{"type", "point"}, {"color", {1, 1}}}, Json{{"type", "area"}}, Json{{"type", "spot"}}}) {
    const auto refused = test::load(lit(light));
    ASSERT_FALSE(refused.has_value()) << light;
    EXPECT_THAT(refused.error().message, testing::HasSubstr("/extensions/KHR_lights_punctual/lights/0/"))
        << light;
  }
}

TEST(Cameras, ArePlacedByTheirNodes) {
  GltfSketch sketch;
  sketch.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
  sketch.add("cameras", {{"type", "orthographic"},
                         {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 10}, {"znear", 0.1}}}});
  const double half = std::sqrt(0.5);
  sketch.add("nodes", {{"camera", 0}, {"translation", {1, 2, 3}}, {"rotation", {0, half, 0, half}}});
  sketch.add("nodes", {{"camera", 1}});
  sketch.json["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = test::load_good(sketch);
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].position, glm::dvec3(1, 2, 3));
  // A quarter turn around Y takes -Z to -X.
  EXPECT_LT(glm::distance(scene.cameras[0].forward, glm::dvec3(-1, 0, 0)), 1e-12);
  EXPECT_LT(glm::distance(scene.cameras[0].up, glm::dvec3(0, 1, 0)), 1e-12);
  EXPECT_EQ(scene.cameras[0].vertical_field_of_view, 0.8);
  EXPECT_TRUE(test::warns(scene, "camera"));
}

}  // namespace
}  // namespace relume
