// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/gltf_sketch.h"
#include "scene/surface_color.h"

namespace relume {
namespace {

using test::GltfSketch;
using test::Json;
using testing::HasSubstr;
using testing::Not;

/// Seven nodes "n0" to "n6" that show one triangle at different heights, and a light.
GltfSketch tower() {
  GltfSketch sketch = test::one_triangle({{"name", "n0"}});
  for (int i = 1; i < 7; ++i) {
    const int node =
        sketch.add("nodes", {{"name", "n" + std::to_string(i)}, {"mesh", 0}, {"translation", {0, i, 0}}});
    sketch.json["scenes"][0]["nodes"].push_back(node);
  }
  sketch.add("materials", {{"name", "paint"}});
  sketch.json["meshes"][0]["primitives"][0]["material"] = 0;
  sketch.json["extensions"]["KHR_lights_punctual"]["lights"] =
      Json::array({{{"type", "point"}, {"intensity", 10}}});
  sketch.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  return sketch;
}

/// A model that was precomputed from the tower.
Model tower_model() {
  const Scene scene = test::load_good(tower());
  const GeometryHash hash = geometry_hash(scene);
  Model model;
  model.geometry_hash = hash.total;
  model.nodes = hash.nodes;
  model.provenance.scene_file = "tower.gltf";
  return model;
}

void expect_same(const GltfSketch& edited) {
  const auto same = check_same_geometry(tower_model(), test::load_good(edited));
  EXPECT_TRUE(same.has_value()) << same.error().message;
}

std::string difference(const GltfSketch& edited) {
  const auto same = check_same_geometry(tower_model(), test::load_good(edited));
  if (same) return "none";
  EXPECT_EQ(same.error().code, ErrorCode::bad_input);
  EXPECT_THAT(same.error().message,
              testing::StartsWith("scene.gltf: its geometry is not that of tower.gltf"));
  return same.error().message;
}

TEST(GeometryHash, ColoursAndLightsDoNotCount) {
  GltfSketch edited = tower();
  edited.json["materials"][0]["pbrMetallicRoughness"] = {{"baseColorFactor", {0.1, 0.2, 0.3, 1.0}}};
  edited.json["materials"][0]["emissiveFactor"] = {1, 1, 0};
  edited.json["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = 500;
  edited.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  expect_same(edited);
}

TEST(GeometryHash, AMatrixIsAsGoodAsATranslation) {
  GltfSketch edited = tower();
  edited.json["nodes"][3].erase("translation");
  edited.json["nodes"][3]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 3, 0, 1};
  expect_same(edited);
}

TEST(GeometryHash, AMovedNodeIsNamed) {
  GltfSketch edited = tower();
  edited.json["nodes"][4]["translation"] = {0, 4.001, 0};
  EXPECT_THAT(difference(edited), HasSubstr("moved or changed: n4"));
  EXPECT_THAT(difference(edited), Not(HasSubstr("n3")));
}

TEST(GeometryHash, AtMostFiveNodesAreNamed) {
  GltfSketch edited = tower();
  const int root = edited.add("nodes", {{"name", "up"}, {"translation", {0, 0, 9}}});
  for (int i = 0; i < 7; ++i) {
    edited.json["nodes"][static_cast<std::size_t>(i)]["translation"] = {5, i, 0};
  }
  edited.json["scenes"][0]["nodes"].push_back(root);
  EXPECT_THAT(difference(edited), HasSubstr("moved or changed: n0, n1, n2, n3, n4 and 2 more"));
}

TEST(GeometryHash, NewAndMissingNodesAreNamed) {
  GltfSketch edited = tower();
  edited.json["nodes"][2]["name"] = "other";
  EXPECT_THAT(difference(edited), HasSubstr("new: other; gone: n2"));
}

TEST(GeometryHash, OrderSidesMaterialsAndStandingStillCount) {
  GltfSketch reordered = tower();
  std::swap(reordered.json["scenes"][0]["nodes"][1], reordered.json["scenes"][0]["nodes"][2]);
  EXPECT_THAT(difference(reordered), HasSubstr("another order"));

  GltfSketch two_sided = tower();
  two_sided.json["materials"][0]["doubleSided"] = true;
  EXPECT_THAT(difference(two_sided), HasSubstr("n0, n1"));

  GltfSketch assigned = tower();
  assigned.add("materials", {{"name", "varnish"}});
  assigned.json["meshes"].push_back(assigned.json["meshes"][0]);
  assigned.json["meshes"][1]["primitives"][0]["material"] = 1;
  assigned.json["nodes"][5]["mesh"] = 1;
  EXPECT_THAT(difference(assigned), HasSubstr("moved or changed: n5"));

  GltfSketch moving = tower();
  moving.json["nodes"][6]["extras"]["relume"]["static"] = false;
  EXPECT_THAT(difference(moving), HasSubstr("moved or changed: n6"));

  GltfSketch cut_out = tower();
  cut_out.json["materials"][0]["alphaMode"] = "MASK";
  EXPECT_THAT(difference(cut_out), HasSubstr("n0, n1"));
}

}  // namespace
}  // namespace relume
