// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "scene/gltf_sketch.h"
#include "scene/load_scene.h"

namespace relume {
namespace {

using test::GltfSketch;
using test::Json;
using testing::ElementsAre;

std::vector<std::string> paths(const Scene& scene) {
  std::vector<std::string> out;
  for (const auto& node : scene.nodes) out.push_back(node.path);
  return out;
}

/// The triangle's mesh below a parent: node 0 shows it, node 1 is its parent and the root.
GltfSketch with_parent(Json child, Json parent) {
  GltfSketch sketch = test::one_triangle(std::move(child));
  parent["children"] = {0};
  sketch.add("nodes", std::move(parent));
  sketch.json["scenes"][0]["nodes"] = {1};
  return sketch;
}

TEST(Nodes, TransformsAreMultipliedFromTheRoot) {
  // Rotation by 90 degrees around Z takes (1 0 0) to (0 1 0); then x 2 and + (10 20 30).
  const double half = std::sqrt(0.5);
  const auto sketch =
      with_parent({{"rotation", {0, 0, half, half}}}, {{"translation", {10, 20, 30}}, {"scale", {2, 2, 2}}});
  const auto p = test::corners(test::load_good(sketch), 0);
  EXPECT_LT(glm::distance(p[0], glm::dvec3(10, 20, 30)), 1e-12);
  EXPECT_LT(glm::distance(p[1], glm::dvec3(10, 22, 30)), 1e-12);
  EXPECT_LT(glm::distance(p[2], glm::dvec3(8, 20, 30)), 1e-12);
}

TEST(Nodes, MatricesAreColumnMajor) {
  const auto p = test::corners(
      test::load_good(test::one_triangle({{"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}})),
      0);
  EXPECT_EQ(p[0], glm::dvec3(5, 6, 7));
  EXPECT_EQ(p[1], glm::dvec3(5, 7, 7));
  EXPECT_EQ(p[2], glm::dvec3(4, 6, 7));
}

TEST(Nodes, AQuaternionNeedNotBeUnitButMustNotBeZero) {
  const auto p = test::corners(test::load_good(test::one_triangle({{"rotation", {0, 0, 3, 3}}})), 0);
  EXPECT_LT(glm::distance(p[1], glm::dvec3(0, 1, 0)), 1e-12);
  const auto refused = test::load(test::one_triangle({{"rotation", {0, 0, 0, 0}}}));
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, testing::HasSubstr("/nodes/0/rotation"));
}

TEST(Nodes, FarAwayGeometryKeepsItsPrecision) {
  const auto p = test::corners(test::load_good(test::one_triangle({{"translation", {1e7, 0, 0}}})), 0);
  EXPECT_EQ(p[1] - p[0], glm::dvec3(1, 0, 0));
  EXPECT_EQ(p[0].x, 1e7);
}

TEST(Nodes, PathsAreUniqueAndNameTheWay) {
  GltfSketch sketch = test::one_triangle({{"name", "box"}});
  const int second = sketch.add("nodes", {{"name", "box"}, {"mesh", 0}, {"translation", {0, 0, 1}}});
  const int unnamed = sketch.add("nodes", {{"mesh", 0}, {"translation", {0, 0, 2}}});
  const int root = sketch.add("nodes", {{"name", "room"}, {"children", {0, second, unnamed}}});
  sketch.json["scenes"][0]["nodes"] = {root};
  EXPECT_THAT(paths(test::load_good(sketch)), ElementsAre("room/box", "room/box#2", "room/node2"));
}

TEST(Nodes, OnlyTheChosenSceneIsRead) {
  GltfSketch sketch = test::one_triangle({{"name", "first"}});
  const int other = sketch.add("nodes", {{"name", "other"}, {"mesh", 0}});
  sketch.json["scenes"].push_back({{"nodes", {other}}});
  EXPECT_THAT(paths(test::load_good(sketch)), ElementsAre("first"));
  sketch.json["scene"] = 1;
  EXPECT_THAT(paths(test::load_good(sketch)), ElementsAre("other"));
  sketch.json.erase("scene");
  sketch.json.erase("scenes");
  const Scene all = test::load_good(sketch);
  EXPECT_THAT(paths(all), ElementsAre("first", "other"));
  EXPECT_TRUE(test::warns(all, "it holds no scene"));
}

TEST(Nodes, AChainOfFiftyThousandIsWalkedWithoutRecursion) {
  constexpr int kNodes = 50000;
  GltfSketch sketch = test::one_triangle();
  Json nodes = Json::array();
  for (int i = 0; i < kNodes; ++i) nodes.push_back({{"translation", {0.5, 0, 0}}, {"children", {i + 1}}});
  nodes.push_back({{"mesh", 0}});
  sketch.json["nodes"] = nodes;
  sketch.json["scenes"][0]["nodes"] = {0};
  const Scene scene = test::load_good(sketch);
  EXPECT_EQ(test::corners(scene, 0)[0], glm::dvec3(kNodes * 0.5, 0, 0));
  EXPECT_LT(scene.nodes.at(0).path.size(), 1000u);
}

TEST(Nodes, InstancesBecomeNodesOfTheirOwn) {
  GltfSketch sketch = test::one_triangle({{"name", "tree"}});
  const int translations = sketch.add_floats({0, 0, 1, 0, 0, 2}, "VEC3");
  const int scales = sketch.add_floats({1, 1, 1, 3, 1, 1}, "VEC3");
  const double half = std::sqrt(0.5);
  const auto h = static_cast<float>(half);
  const int rotations = sketch.add_floats({0, 0, 0, 1, 0, 0, h, h}, "VEC4");
  sketch.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", translations}, {"ROTATION", rotations}, {"SCALE", scales}};
  sketch.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const Scene scene = test::load_good(sketch);
  EXPECT_THAT(paths(scene), ElementsAre("tree", "tree#2"));
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(test::corners(scene, 0)[1], glm::dvec3(1, 0, 1));
  // x 3 first, then a quarter turn around Z; a float holds sqrt(1/2) to 6e-8.
  EXPECT_LT(glm::distance(test::corners(scene, 1)[1], glm::dvec3(0, 3, 2)), 1e-6);
}

TEST(Nodes, InstanceAttributesMustBeOfOneLength) {
  GltfSketch sketch = test::one_triangle();
  const int translations = sketch.add_floats({0, 0, 1, 0, 0, 2}, "VEC3");
  const int scales = sketch.add_floats({1, 1, 1}, "VEC3");
  sketch.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", translations}, {"SCALE", scales}};
  const auto refused = test::load(sketch);
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, testing::HasSubstr("/nodes/0/extensions/EXT_mesh_gpu_instancing"));
}

TEST(Nodes, ExtrasAreReadAndInherited) {
  const auto sketch = with_parent({{"extras", {{"relume", {{"quality", 64}, {"receiver", "none"}}}}}},
                                  {{"extras",
                                    {{"relume",
                                      {{"system", "hall"},
                                       {"texel_size", 0.25},
                                       {"quality", 16},
                                       {"budget", 300},
                                       {"emitter", true}}}}}});
  const auto extras = test::load_good(sketch).nodes.at(0).extras;
  EXPECT_EQ(extras.system, "hall");
  EXPECT_EQ(extras.texel_size, 0.25);
  EXPECT_EQ(extras.quality, 64u);
  EXPECT_EQ(extras.budget, 300u);
  EXPECT_EQ(extras.receiver, "none");
  EXPECT_EQ(extras.emitter, true);
  EXPECT_FALSE(extras.is_static.has_value());
}

TEST(Nodes, AnUnknownWordInExtrasIsNamed) {
  const Scene scene = test::load_good(test::one_triangle({{"extras", {{"relume", {{"texelsize", 1}}}}}}));
  EXPECT_TRUE(test::warns(scene, "/nodes/0/extras/relume/texelsize"));
}

TEST(Nodes, NodesThatSaySoAreDynamic) {
  const Scene scene = test::load_good(
      with_parent({{"name", "door"}}, {{"name", "house"}, {"extras", {{"relume", {{"static", false}}}}}}));
  EXPECT_TRUE(scene.triangles.empty());
  ASSERT_EQ(scene.nodes.size(), 1u);
  EXPECT_FALSE(scene.nodes[0].is_static);
  EXPECT_EQ(scene.dropped.dynamic, 1u);
}

/// An animation of one property of one node.
void animate(GltfSketch& sketch, int node, const char* path) {
  const int times = sketch.add_floats({0, 1}, "SCALAR");
  const int values = sketch.add_floats({0, 0, 0, 1, 1, 1}, "VEC3");
  sketch.add("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}}});
}

TEST(Nodes, AnimatedParentsMakeTheirChildrenDynamic) {
  GltfSketch sketch = with_parent({}, {});
  animate(sketch, 1, "translation");
  const Scene scene = test::load_good(sketch);
  EXPECT_TRUE(scene.triangles.empty());
  EXPECT_TRUE(test::warns(scene, "left out: 1 with 1 triangles"));
}

TEST(Nodes, AnimatedNodesMaySayThatTheyAreStatic) {
  GltfSketch sketch = test::one_triangle({{"extras", {{"relume", {{"static", true}}}}}});
  animate(sketch, 0, "rotation");
  EXPECT_EQ(test::load_good(sketch).triangles.size(), 1u);
}

TEST(Nodes, SkinnedNodesAreDynamic) {
  GltfSketch sketch = test::one_triangle({{"skin", 0}});
  const int joint = sketch.add("nodes", {{"name", "bone"}});
  sketch.json["scenes"][0]["nodes"].push_back(joint);
  sketch.add("skins", {{"joints", {joint}}});
  const Scene scene = test::load_good(sketch);
  EXPECT_TRUE(scene.triangles.empty());
  EXPECT_TRUE(test::warns(scene, "animated and skinned nodes"));
}

TEST(Nodes, TooManyTrianglesAreRefusedBeforeTheyAreMade) {
  GltfSketch sketch = test::one_triangle();
  for (int i = 0; i < 9; ++i) {
    sketch.json["scenes"][0]["nodes"].push_back(sketch.add("nodes", {{"mesh", 0}}));
  }
  const test::ScratchFolder folder;
  SceneLimits limits;
  limits.max_triangles = 9;
  const auto refused = load_scene(sketch.write(folder), limits);
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, testing::HasSubstr("at most 9 triangles in all, found 10"));
}

}  // namespace
}  // namespace relume
