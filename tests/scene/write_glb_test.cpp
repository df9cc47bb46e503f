// SPDX-License-Identifier: MIT
#include "scene/write_glb.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "scene/gltf_sketch.h"
#include "scene/load_scene.h"
#include "scene/surface_color.h"

namespace relume {
namespace {

GlbPrimitive triangle() {
  GlbPrimitive mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

Scene round_trip(const GlbScene& glb) {
  const test::ScratchFolder folder;
  const auto written = write_glb(glb, folder.path() / "scene.glb");
  EXPECT_TRUE(written.has_value()) << written.error().message;
  auto scene = load_scene(folder.path() / "scene.glb");
  if (!scene) {
    ADD_FAILURE() << scene.error().message;
    return {};
  }
  EXPECT_TRUE(scene->warnings.empty());
  return std::move(*scene);
}

TEST(WriteGlb, AttributesAndMaterialsComeBack) {
  GlbScene glb;
  glb.images = {test::png(1, 1, {255, 0, 0, 255})};
  GlbMaterial lamp;
  lamp.name = "lamp";
  lamp.base_color = {0.25, 0.5, 0.75};
  lamp.emission = {1000.0, 333.3, 0.1};
  lamp.double_sided = true;
  GlbMaterial shown;
  shown.name = "shown";
  shown.unlit = true;
  shown.base_color_texture = GlbTexture{0, 1, WrapMode::clamp_to_edge};
  glb.materials = {lamp, shown};
  GlbPrimitive first = triangle();
  first.material = 0;
  first.normals.assign(3, {0, 0, 1});
  first.colors.assign(3, {0.5f, 1.0f, 0.25f, 1.0f});
  GlbPrimitive second = triangle();
  second.material = 1;
  second.positions[2] = {0, 2, 0};
  second.uv0 = {{0, 0}, {1, 0}, {0, 1}};
  second.uv1 = {{0.1f, 0.2f}, {0.3f, 0.4f}, {0.5f, 0.6f}};
  glb.meshes = {{"mesh", {first, second}}};
  glb.nodes.resize(1);
  glb.nodes[0].name = "shape";
  glb.nodes[0].mesh = 0;
  const Scene scene = round_trip(glb);
  ASSERT_EQ(scene.surfaces.size(), 2u);
  EXPECT_EQ(scene.materials.at(0).emission, lamp.emission) << "a power of two as strength loses nothing";
  EXPECT_EQ(scene.materials.at(0).base_color, lamp.base_color);
  EXPECT_TRUE(scene.materials.at(0).double_sided);
  EXPECT_TRUE(scene.materials.at(1).unlit);
  EXPECT_EQ(scene.materials.at(1).base_color_texture->uv_set, 1u);
  EXPECT_EQ(scene.materials.at(1).base_color_texture->wrap_s, WrapMode::clamp_to_edge);
  EXPECT_THAT(scene.images.at(0).rgba, testing::ElementsAre(255, 0, 0, 255));
  EXPECT_EQ(scene.vertices.colors.at(0), glm::vec4(0.5f, 1.0f, 0.25f, 1.0f));
  EXPECT_EQ(scene.vertices.uv1.at(5), glm::vec2(0.5f, 0.6f));
  EXPECT_EQ(test::triangle_normal(scene, 1), glm::dvec3(0, 0, 2));
}

TEST(WriteGlb, NodesLightsAndCamerasComeBack) {
  GlbScene glb;
  glb.meshes = {{"mesh", {triangle()}}};
  GlbNode root;
  root.name = "root";
  root.transform[3] = {1.0, 2.0, 3.0, 1.0};
  root.extras.system = "hall";
  GlbNode child;
  child.name = "child";
  child.parent = 0;
  child.mesh = 0;
  child.transform[0] = {0.0, 2.0, 0.0, 0.0};
  child.transform[1] = {-2.0, 0.0, 0.0, 0.0};
  child.extras.emitter = true;
  glb.nodes = {root, child};
  Light spot;
  spot.type = LightType::spot;
  spot.name = "spot";
  spot.position = {4.0, 5.0, 6.0};
  spot.direction = glm::normalize(glm::dvec3(1.0, -2.0, 0.5));
  spot.intensity = {30.0, 20.0, 10.0};
  spot.range = 9.0;
  spot.inner_cone_angle = 0.2;
  spot.outer_cone_angle = 0.4;
  add_light(glb, spot);
  Light sun;
  sun.type = LightType::directional;
  sun.direction = {0.0, -1.0, 0.0};
  add_light(glb, sun);
  add_camera(glb, "camera", {{0.0, 1.0, 2.0}, {0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}, 0.7});
  const Scene scene = round_trip(glb);
  ASSERT_EQ(scene.nodes.size(), 1u);
  EXPECT_EQ(scene.nodes[0].path, "root/child");
  EXPECT_EQ(scene.nodes[0].extras.system, "hall");
  EXPECT_EQ(scene.nodes[0].extras.emitter, true);
  EXPECT_EQ(test::corners(scene, 0)[1], glm::dvec3(1, 4, 3));
  EXPECT_EQ(test::corners(scene, 0)[2], glm::dvec3(-1, 2, 3));
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].position, spot.position);
  EXPECT_LT(glm::distance(scene.lights[0].direction, spot.direction), 1e-12);
  EXPECT_LT(glm::distance(scene.lights[0].intensity, spot.intensity), 1e-12);
  EXPECT_EQ(scene.lights[0].range, 9.0);
  EXPECT_EQ(scene.lights[0].inner_cone_angle, 0.2);
  EXPECT_EQ(scene.lights[0].outer_cone_angle, 0.4);
  EXPECT_LT(glm::distance(scene.lights[1].direction, sun.direction), 1e-12)
      << "straight down has no natural up";
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].forward, glm::dvec3(0, 0, -1));
  EXPECT_EQ(scene.cameras[0].vertical_field_of_view, 0.7);
}

TEST(WriteGlb, ManyVerticesNeedWideIndices) {
  GlbPrimitive mesh;
  for (int i = 0; i < 70000; ++i) mesh.positions.emplace_back(float(i % 300), float(i / 300), 0.0f);
  mesh.triangles = {{0, 1, 300}, {69998, 69999, 69500}};
  GlbScene glb;
  glb.meshes = {{"mesh", {mesh}}};
  glb.nodes.resize(1);
  glb.nodes[0].mesh = 0;
  const Scene scene = round_trip(glb);
  ASSERT_EQ(scene.triangles.size(), 2u);
  EXPECT_EQ(test::corners(scene, 1)[1], glm::dvec3(69999 % 300, 69999 / 300, 0));
}

TEST(WriteGlb, TheSameSceneGivesTheSameBytes) {
  GlbScene glb;
  glb.meshes = {{"mesh", {triangle()}}};
  glb.nodes.resize(1);
  glb.nodes[0].mesh = 0;
  EXPECT_EQ(*encode_glb(glb), *encode_glb(glb));
  EXPECT_EQ(encode_glb(glb)->size() % 4, 0u);
}

TEST(WriteGlb, PartsThatDoNotFitAreRefused) {
  GlbScene glb;
  glb.meshes = {{"mesh", {triangle()}}};
  glb.nodes.resize(1);
  const auto refused = [](const GlbScene& scene) {
    const auto bytes = encode_glb(scene);
    return !bytes && bytes.error().code == ErrorCode::usage;
  };
  GlbScene bad_index = glb;
  bad_index.meshes[0].primitives[0].triangles[0][1] = 3;
  EXPECT_TRUE(refused(bad_index));
  GlbScene bad_length = glb;
  bad_length.meshes[0].primitives[0].uv1.resize(2);
  EXPECT_TRUE(refused(bad_length));
  GlbScene bad_mesh = glb;
  bad_mesh.nodes[0].mesh = 1;
  EXPECT_TRUE(refused(bad_mesh));
  GlbScene bad_material = glb;
  bad_material.meshes[0].primitives[0].material = 0;
  EXPECT_TRUE(refused(bad_material));
  GlbScene empty_mesh = glb;
  empty_mesh.meshes[0].primitives[0].triangles.clear();
  EXPECT_TRUE(refused(empty_mesh));
  EXPECT_FALSE(refused(glb));
}

}  // namespace
}  // namespace relume
