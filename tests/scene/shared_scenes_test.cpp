// SPDX-License-Identifier: MIT
//
// The shared scenes load with the triangle counts of their manifest, and those that it calls equal are equal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "scene/gltf_sketch.h"
#include "scene/load_scene.h"
#include "scene/shared_files.h"
#include "scene/surface_color.h"

namespace relume {
namespace {

struct SharedScene {
  const char* name;
  std::uint64_t triangles;  ///< of the file, instances expanded
};

void PrintTo(const SharedScene& scene, std::ostream* out) {
  *out << scene.name;
}

void check_consistency(const Scene& scene) {
  std::uint32_t next = 0;
  for (const auto& surface : scene.surfaces) {
    EXPECT_EQ(surface.first_triangle, next);
    next += surface.triangle_count;
    EXPECT_LT(surface.node, scene.nodes.size());
    EXPECT_LT(surface.material, scene.materials.size());
  }
  EXPECT_EQ(next, scene.triangles.size());
  EXPECT_EQ(scene.vertices.uv0.size(), scene.vertices.positions.size());
  EXPECT_EQ(scene.vertices.uv1.size(), scene.vertices.positions.size());
  EXPECT_EQ(scene.vertices.colors.size(), scene.vertices.positions.size());
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    ASSERT_GT(glm::length(test::triangle_normal(scene, t)), 0.0);
  }
}

class SharedScenes : public testing::TestWithParam<SharedScene> {};

TEST_P(SharedScenes, LoadWithAllTriangles) {
  const auto shared = test::shared_files();
  if (!shared) GTEST_SKIP() << "the shared files are not beside the repository";
  const auto scene = load_scene(*shared / "scenes" / GetParam().name);
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  const auto& dropped = scene->dropped;
  EXPECT_EQ(scene->triangles.size() + dropped.without_area + dropped.repeated + dropped.not_finite +
                dropped.dynamic,
            GetParam().triangles);
  EXPECT_EQ(dropped.not_finite, 0u);
  EXPECT_EQ(dropped.dynamic, 0u);
  check_consistency(*scene);
}

// simple-instancing: the manifest counts one instance; EXT_mesh_gpu_instancing has 125 of 12 triangles.
// Mesh_PrimitiveMode_01 holds points.
INSTANTIATE_TEST_SUITE_P(
    Manifest, SharedScenes,
    testing::Values(
        SharedScene{"garage/garage.gltf", 11358}, SharedScene{"cave/cave.gltf", 5894},
        SharedScene{"living_room.glb", 5088}, SharedScene{"godot_room.glb", 63720},
        SharedScene{"godot_town.glb", 30477}, SharedScene{"babylon_cornellBox.glb", 4006},
        SharedScene{"tile-game-room6.glb", 88}, SharedScene{"webxr_hall.glb", 6391},
        SharedScene{"institute.glb", 35376}, SharedScene{"turbine.glb", 3064},
        SharedScene{"japanese_bridge_garden.glb", 21883}, SharedScene{"hotel_room.glb", 99029},
        SharedScene{"pc_house.glb", 10497}, SharedScene{"kaykit_dungeon.glb", 53540},
        SharedScene{"odd/BoxBadNormals.glb", 12}, SharedScene{"odd/BoxMeshopt.glb", 12},
        SharedScene{"odd/BoxTextured_dataURI.gltf", 12}, SharedScene{"odd/Buffer_Interleaved_00.gltf", 2},
        SharedScene{"odd/Compatibility_01.gltf", 2}, SharedScene{"odd/Lights.glb", 12},
        SharedScene{"odd/Mesh_PrimitiveMode_01.gltf", 0}, SharedScene{"odd/Mesh_PrimitiveMode_04.gltf", 2},
        SharedScene{"odd/Mesh_PrimitiveMode_06.gltf", 2}, SharedScene{"odd/Mesh_PrimitiveMode_13.gltf", 2},
        SharedScene{"odd/Node_Attribute_02.gltf", 54}, SharedScene{"odd/Node_NegativeScale_01.gltf", 54},
        SharedScene{"odd/Node_NegativeScale_04.gltf", 54}, SharedScene{"odd/Node_NegativeScale_08.gltf", 54},
        SharedScene{"odd/TwoCubes.glb", 24}, SharedScene{"odd/living_room_quantized.glb", 5088},
        SharedScene{"odd/room_degenerate.glb", 90}, SharedScene{"odd/room_noindices.glb", 88},
        SharedScene{"odd/simple-instancing.glb", 1500},
        SharedScene{"odd/singleBlendshapeCube_sparse.glb", 12},
        SharedScene{"odd/uri_spaces/CubeImageUriMultipleSpaces.gltf", 12},
        SharedScene{"odd/uri_spaces/CubeImageUriSpaces.gltf", 12},
        SharedScene{"odd/zero-sized-bin-chunk-issue-440.glb", 1}),
    [](const auto& named) {
      std::string name = named.param.name;
      std::replace_if(
          name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
      return name;
    });

class SharedPairs : public testing::Test {
 protected:
  Scene scene(const char* name) {
    const auto shared = test::shared_files();
    auto loaded = load_scene(*shared / "scenes" / name);
    if (!loaded) {
      ADD_FAILURE() << loaded.error().message;
      return {};
    }
    return std::move(*loaded);
  }
  void SetUp() override {
    if (!test::shared_files()) GTEST_SKIP() << "the shared files are not beside the repository";
  }
};

void expect_same_colors(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (std::uint32_t t = 0; t < a.triangles.size(); ++t) {
    const std::array<glm::vec2, 3> whole = {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)};
    EXPECT_EQ(mean_color(a, t, whole).albedo, mean_color(b, t, whole).albedo);
  }
}

TEST_F(SharedPairs, WithoutIndicesIsTheSameRoom) {
  const Scene a = scene("tile-game-room6.glb");
  const Scene b = scene("odd/room_noindices.glb");
  EXPECT_EQ(geometry_hash(a).total, geometry_hash(b).total);
  expect_same_colors(a, b);
}

TEST_F(SharedPairs, DegenerateTrianglesAreDroppedWithOneWarning) {
  const Scene a = scene("tile-game-room6.glb");
  const Scene b = scene("odd/room_degenerate.glb");
  EXPECT_EQ(geometry_hash(a).total, geometry_hash(b).total);
  EXPECT_EQ(b.dropped.without_area, 1u);
  EXPECT_EQ(b.dropped.repeated, 1u);
  ASSERT_EQ(b.warnings.size(), 1u);
  EXPECT_THAT(b.warnings[0], testing::HasSubstr("dropped triangles: 1 without area, 1 repeated"));
  expect_same_colors(a, b);
}

TEST_F(SharedPairs, QuantizedRoomIsWithinItsPrecision) {
  const Scene a = scene("living_room.glb");
  const Scene b = scene("odd/living_room_quantized.glb");
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  const double extent = 14.5;  // longest side, by the manifest
  double farthest = 0.0;
  for (std::size_t t = 0; t < a.triangles.size(); ++t) {
    const auto p = test::corners(a, t);
    const auto q = test::corners(b, t);
    for (std::size_t c = 0; c < 3; ++c) farthest = std::max(farthest, glm::distance(p[c], q[c]));
  }
  EXPECT_LE(farthest, 2e-4 * extent);
  EXPECT_GT(farthest, 0.0) << "16-bit positions cannot be exact";
}

TEST_F(SharedPairs, RoomsOfTheTruthSetShareTheirGeometry) {
  const auto a = geometry_hash(scene("../truth/room_A.glb"));
  EXPECT_EQ(a.total, geometry_hash(scene("../truth/room_B.glb")).total);
  EXPECT_EQ(a.total, geometry_hash(scene("../truth/room_C.glb")).total);
  EXPECT_EQ(a.nodes.size(), 15u);
}

TEST_F(SharedPairs, LightsAndMaterialsOfATruthRoom) {
  const Scene room = scene("../truth/room_B.glb");
  std::ifstream in(*test::shared_files() / "truth" / "room_B.json");
  const auto truth = nlohmann::json::parse(in);
  ASSERT_EQ(room.lights.size(), 2u);
  const auto triple = [](const nlohmann::json& j) { return glm::dvec3(j[0], j[1], j[2]); };
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& said = truth["lights"][i];
    const auto light = std::find_if(room.lights.begin(), room.lights.end(),
                                    [&](const Light& l) { return l.name == said["name"]; });
    ASSERT_NE(light, room.lights.end());
    // The .glb holds positions and rotations as decimal text of about 9 digits.
    EXPECT_LT(glm::distance(light->position, triple(said["pos"])), 1e-6);
    EXPECT_LT(glm::distance(light->intensity, triple(said["candela"])), 1e-5);
    if (said["type"] != "spot") continue;
    EXPECT_LT(glm::distance(light->direction, triple(said["dir"])), 1e-6);
    EXPECT_NEAR(light->inner_cone_angle, said["inner_cone_deg"].get<double>() * kPi / 180.0, 1e-6);
    EXPECT_NEAR(light->outer_cone_angle, said["outer_cone_deg"].get<double>() * kPi / 180.0, 1e-6);
  }
  for (const auto& material : room.materials) {
    const auto& said = truth["materials"].at(material.name);
    EXPECT_LT(glm::distance(material.base_color, triple(said["albedo"])), 1e-6) << material.name;
    EXPECT_LT(glm::distance(material.emission, triple(said["emissive_radiance"])), 1e-6) << material.name;
  }
}

/// Signed volume of a closed mesh: positive when its fronts look outwards.
double volume(const Scene& scene) {
  double sum = 0.0;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const auto p = test::corners(scene, t);
    sum += glm::dot(p[0], glm::cross(p[1], p[2])) / 6.0;
  }
  return sum;
}

TEST_F(SharedPairs, CompressedAndPlainBoxesHaveUnitVolume) {
  EXPECT_NEAR(volume(scene("odd/BoxTextured_dataURI.gltf")), 1.0, 1e-6);
  EXPECT_NEAR(volume(scene("odd/BoxBadNormals.glb")), 1.0, 1e-6);
  // Quantized to 14 bits or so: a corner is off by at most 1e-4.
  EXPECT_NEAR(volume(scene("odd/BoxMeshopt.glb")), 1.0, 6e-4);
}

TEST_F(SharedPairs, DracoIsNamedWhereItIsMissed) {
  const auto refused = load_scene(*test::shared_files() / "scenes/odd/BoxDraco/BoxDraco.gltf");
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, testing::HasSubstr("KHR_draco_mesh_compression"));
}

TEST_F(SharedPairs, LightsOfTheOddFile) {
  const Scene lit = scene("odd/Lights.glb");
  EXPECT_EQ(lit.lights.size(), 4u);
  EXPECT_EQ(lit.cameras.size(), 1u);
}

}  // namespace
}  // namespace relume
