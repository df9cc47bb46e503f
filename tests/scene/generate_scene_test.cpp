// SPDX-License-Identifier: MIT
#include "scene/generate_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "scene/gltf_sketch.h"
#include "scene/load_scene.h"

namespace relume {
namespace {

Scene generated(const std::string& name) {
  const auto glb = generate_scene(name);
  if (!glb) {
    ADD_FAILURE() << glb.error().message;
    return {};
  }
  const test::ScratchFolder folder;
  EXPECT_TRUE(write_glb(*glb, folder.path() / "scene.glb").has_value());
  auto scene = load_scene(folder.path() / "scene.glb");
  if (!scene) {
    ADD_FAILURE() << scene.error().message;
    return {};
  }
  EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
  return std::move(*scene);
}

/// Positive when the fronts of a closed surface look outwards.
double volume(const Scene& scene) {
  double sum = 0.0;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const auto p = test::corners(scene, t);
    sum += glm::dot(p[0], glm::cross(p[1], p[2])) / 6.0;
  }
  return sum;
}

/// Vector area of all triangles: zero for a surface without holes.
glm::dvec3 vector_area(const Scene& scene) {
  glm::dvec3 sum(0.0);
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) sum += test::triangle_normal(scene, t) / 2.0;
  return sum;
}

double area(const Scene& scene, const std::string& path) {
  double sum = 0.0;
  for (const auto& surface : scene.surfaces) {
    if (scene.nodes[surface.node].path != path) continue;
    for (std::uint32_t t = 0; t < surface.triangle_count; ++t) {
      sum += glm::length(test::triangle_normal(scene, surface.first_triangle + t)) / 2.0;
    }
  }
  return sum;
}

TEST(GenerateScene, AllLoadWithoutWarnings) {
  for (const auto& name : scene_names()) {
    const Scene scene = generated(name);
    EXPECT_FALSE(scene.triangles.empty()) << name;
    for (const auto& material : scene.materials)
      EXPECT_FALSE(material.double_sided && name != "demo") << name;
  }
}

TEST(GenerateScene, AnUnknownNameListsTheKnownOnes) {
  const auto refused = generate_scene("kitchen");
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("two_rooms_sealed"));
}

TEST(GenerateScene, FurnacesLookInwards) {
  EXPECT_NEAR(volume(generated("furnace_box")), -1.0, 1e-12);
  // A sphere of 24 rings and 48 segments holds a little less than 4/3 pi; the ring of side s loses about
  // s^2/4.
  const double sphere = volume(generated("furnace_sphere"));
  EXPECT_LT(sphere, -4.0 / 3.0 * kPi * 0.98);
  EXPECT_GT(sphere, -4.0 / 3.0 * kPi);
  EXPECT_LT(glm::length(vector_area(generated("furnace_sphere"))), 1e-6);
}

TEST(GenerateScene, CapAndWallOfTheSphereMeet) {
  const Scene scene = generated("cap_sphere");
  EXPECT_LT(glm::length(vector_area(scene)), 1e-6);
  EXPECT_LT(volume(scene), 0.0);
  // Area of a cap of 40 degrees: 2 pi (1 - cos 40); the facets lose less than 1 %.
  const double cap = 2.0 * kPi * (1.0 - std::cos(40.0 * kPi / 180.0));
  EXPECT_NEAR(area(scene, "cap"), cap, 0.01 * cap);
}

TEST(GenerateScene, RoomsAreClosed) {
  for (const char* name : {"lamp_room", "two_rooms", "two_rooms_sealed"}) {
    // Boxes stand on the floor without bottoms: what is missing of each is an upward area.
    const glm::dvec3 open = vector_area(generated(name));
    EXPECT_NEAR(open.x, 0.0, 1e-5) << name;
    EXPECT_NEAR(open.z, 0.0, 1e-5) << name;
  }
  EXPECT_NEAR(vector_area(generated("lamp_room")).y, 0.0, 1e-5);
  // Bottoms of the four boxes: 0.8 x 0.6 + 0.5 x 0.5 + 0.7 x 0.7 + 0.5 x 0.5; the doorway has the floor as
  // its sill.
  EXPECT_NEAR(vector_area(generated("two_rooms_sealed")).y, 1.47 + 0.1 * 3.2 - 0.1 * 3.2, 1e-5);
  EXPECT_NEAR(vector_area(generated("two_rooms")).y, 1.47 - 0.1 * 0.9, 1e-5);
}

TEST(GenerateScene, TheLampOfTheLampRoom) {
  const Scene scene = generated("lamp_room");
  EXPECT_NEAR(area(scene, "lamp"), 0.09, 1e-6);
  EXPECT_NEAR(area(scene, "ceiling"), 16.0 - 0.09, 1e-5);
}

TEST(GenerateScene, TheDemoIsARoomWithACamera) {
  const Scene scene = generated("demo");
  EXPECT_GT(scene.triangles.size(), 10000u);
  EXPECT_LT(scene.triangles.size(), 40000u);
  EXPECT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.lights.size(), 1u);
  EXPECT_GT(scene.nodes.size(), 30u);
  for (const auto& position : scene.vertices.positions) {
    EXPECT_TRUE(position.x >= -0.23 && position.x <= 5.001 && position.y >= -0.001 && position.y <= 2.701);
  }
  for (const auto& material : scene.materials) {
    EXPECT_GE(std::min({material.base_color.x, material.base_color.y, material.base_color.z}), 0.05)
        << material.name;
    EXPECT_LE(std::max({material.base_color.x, material.base_color.y, material.base_color.z}), 0.85)
        << material.name;
  }
}

}  // namespace
}  // namespace relume
