// SPDX-License-Identifier: MIT
#include "scene/surface_color.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/gltf_sketch.h"

namespace relume {
namespace {

using test::GltfSketch;
using test::Json;

constexpr std::array<glm::vec2, 3> kWhole = {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)};

/// A right triangle of legs 1 whose TEXCOORD_0 are given per corner, with a texture of some pixels.
struct Textured {
  std::vector<float> uv = {0, 0, 1, 0, 0, 1};
  int width = 1;
  int height = 1;
  std::vector<std::uint8_t> rgba;
  Json transform = nullptr;
  Json sampler = nullptr;

  Scene scene() const {
    GltfSketch sketch = test::one_triangle();
    const int at = sketch.add_floats(uv, "VEC2");
    auto& primitive = sketch.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_0"] = at;
    primitive["material"] = 0;
    Json info = {{"index", 0}};
    if (!transform.is_null()) info["extensions"]["KHR_texture_transform"] = transform;
    sketch.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", info}}}});
    Json texture = {{"source", 0}};
    if (!sampler.is_null()) texture["sampler"] = sketch.add("samplers", sampler);
    sketch.add("textures", texture);
    sketch.add("images", {{"uri", "data:image/png;base64," + test::base64(test::png(width, height, rgba))}});
    return test::load_good(sketch);
  }

  Rgb mean(const std::array<glm::vec2, 3>& corners = kWhole) const {
    return mean_color(scene(), 0, corners).albedo;
  }
};

std::vector<std::uint8_t> checkerboard(int size) {
  std::vector<std::uint8_t> rgba;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::uint8_t value = (x + y) % 2 == 0 ? 255 : 0;
      rgba.insert(rgba.end(), {value, value, value, 255});
    }
  }
  return rgba;
}

/// Red, green / blue, white.
const std::vector<std::uint8_t> kFour = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};

TEST(SurfaceColor, SrgbIsDecodedBeforeAveraging) {
  // Half of the texels reflect 1, half 0. The mean of the codes would decode to 0.214.
  const Textured board{.width = 64, .height = 64, .rgba = checkerboard(64)};
  // 4096 points of a low-discrepancy sequence over 2048 texels: well below 2 %.
  EXPECT_NEAR(board.mean().x, 0.5, 0.01);
}

TEST(SurfaceColor, AGreyCodeDecodesByTheStandard) {
  const Textured grey{.rgba = {128, 10, 255, 255}};
  // IEC 61966-2-1 by hand: ((128/255 + 0.055) / 1.055)^2.4, and 10/255 / 12.92.
  EXPECT_NEAR(grey.mean().x, 0.2158605, 1e-6);
  EXPECT_NEAR(grey.mean().y, 0.0030353, 1e-6);
  EXPECT_EQ(grey.mean().z, 1.0);
}

TEST(SurfaceColor, OnlyTheCoveredPartCounts) {
  // Left texel black, right texel white, the triangle runs over u from 0 to 1 at every height.
  const Textured halves{.width = 2, .height = 1, .rgba = {0, 0, 0, 255, 255, 255, 255, 255}};
  // By area, u < 1/2 is 3/4 of the triangle. 16 points can be off by one on each side of the line.
  EXPECT_NEAR(halves.mean().x, 0.25, 2.0 / 16.0);
  const std::array<glm::vec2, 3> left = {glm::vec2(0.0f, 0.0f), glm::vec2(0.4f, 0.0f), glm::vec2(0.0f, 1.0f)};
  const std::array<glm::vec2, 3> right = {glm::vec2(0.6f, 0.0f), glm::vec2(1.0f, 0.0f),
                                          glm::vec2(0.6f, 0.4f)};
  EXPECT_EQ(halves.mean(left), Rgb(0.0));
  EXPECT_EQ(halves.mean(right), Rgb(1.0));
}

TEST(SurfaceColor, ManyTexelsAreAveragedByArea) {
  // A ramp of 256 columns: column x is white for x < 128. u < 1/2 covers 3/4 of the triangle.
  std::vector<std::uint8_t> rgba;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 256; ++x) {
      const std::uint8_t value = x < 128 ? 255 : 0;
      rgba.insert(rgba.end(), {value, value, value, 255});
    }
  }
  const Textured ramp{.width = 256, .height = 64, .rgba = rgba};
  EXPECT_NEAR(ramp.mean().x, 0.75, 0.005);  // 4096 points; a random choice would have 0.007
}

/// The mean of a texture at one uv: a triangle that has it at all corners.
Rgb at_uv(float u, float v, const Json& transform = nullptr, const Json& sampler = nullptr) {
  return Textured{.uv = {u, v, u, v, u, v},
                  .width = 2,
                  .height = 2,
                  .rgba = kFour,
                  .transform = transform,
                  .sampler = sampler}
      .mean();
}

TEST(SurfaceColor, TexelsAreWhereGltfPutsThem) {
  EXPECT_EQ(at_uv(0.25f, 0.25f), Rgb(1, 0, 0)) << "v = 0 is the first row";
  EXPECT_EQ(at_uv(0.75f, 0.25f), Rgb(0, 1, 0));
  EXPECT_EQ(at_uv(0.25f, 0.75f), Rgb(0, 0, 1));
  EXPECT_EQ(at_uv(0.75f, 0.75f), Rgb(1, 1, 1));
}

TEST(SurfaceColor, WrapModes) {
  const Json clamp = {{"wrapS", 33071}, {"wrapT", 33071}};
  const Json mirror = {{"wrapS", 33648}, {"wrapT", 33648}};
  EXPECT_EQ(at_uv(1.25f, 0.25f), Rgb(1, 0, 0)) << "repeat is the default";
  EXPECT_EQ(at_uv(-0.25f, 0.25f), Rgb(0, 1, 0));
  EXPECT_EQ(at_uv(1.25f, 0.25f, nullptr, clamp), Rgb(0, 1, 0));
  EXPECT_EQ(at_uv(-7.0f, 0.25f, nullptr, clamp), Rgb(1, 0, 0));
  EXPECT_EQ(at_uv(1.25f, 0.25f, nullptr, mirror), Rgb(0, 1, 0));
  EXPECT_EQ(at_uv(1.75f, 0.25f, nullptr, mirror), Rgb(1, 0, 0));
}

TEST(SurfaceColor, TextureTransformOffsetsScalesAndRotates) {
  EXPECT_EQ(at_uv(0.25f, 0.25f, {{"offset", {0.5, 0.0}}}), Rgb(0, 1, 0));
  EXPECT_EQ(at_uv(0.25f, 0.25f, {{"scale", {1.0, 3.0}}}), Rgb(0, 0, 1));
  // A quarter turn takes (u, v) to (v, -u): the sense of the Khronos sample model.
  EXPECT_EQ(at_uv(0.25f, 0.75f, {{"rotation", kPi / 2}}), Rgb(1, 1, 1))
      << "(0.75, -0.25) repeats to (0.75, 0.75)";
  EXPECT_EQ(at_uv(0.75f, 0.75f, {{"rotation", kPi / 2}}), Rgb(0, 1, 0))
      << "(0.75, -0.75) repeats to (0.75, 0.25)";
  // Scale first, then rotation, then offset: (0.75, 0.25) -> (0.375, 0.25) -> (0.25, -0.375) -> (0.25,
  // 0.125).
  EXPECT_EQ(at_uv(0.75f, 0.25f, {{"scale", {0.5, 1.0}}, {"rotation", kPi / 2}, {"offset", {0.0, 0.5}}}),
            Rgb(1, 0, 0));
}

TEST(SurfaceColor, VertexColoursAreLinearAndMultiply) {
  GltfSketch sketch = test::one_triangle();
  const int colors = sketch.add_floats({0, 1, 0.5f, 0, 1, 0.5f, 1, 1, 0.5f}, "VEC3");
  auto& primitive = sketch.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["COLOR_0"] = colors;
  primitive["material"] = 0;
  sketch.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {0.6, 0.5, 0.8, 1}}}}});
  const Rgb mean = mean_color(test::load_good(sketch), 0, kWhole).albedo;
  // Red is 0, 0, 1 at the corners: its mean is 1/3 of the factor. Floats hold it to 1e-7.
  EXPECT_NEAR(mean.x, 0.2, 1e-6);
  EXPECT_NEAR(mean.y, 0.5, 1e-6);
  EXPECT_NEAR(mean.z, 0.4, 1e-6);
}

TEST(SurfaceColor, TheEmissionTextureIsAveragedToo) {
  GltfSketch sketch = test::one_triangle();
  const int at = sketch.add_floats({0.75f, 0.25f, 0.75f, 0.25f, 0.75f, 0.25f}, "VEC2");
  auto& primitive = sketch.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_1"] = at;
  primitive["material"] = 0;
  sketch.add("materials",
             {{"emissiveFactor", {1, 0.5, 1}}, {"emissiveTexture", {{"index", 0}, {"texCoord", 1}}}});
  sketch.add("textures", {{"source", 0}});
  sketch.add("images", {{"uri", "data:image/png;base64," + test::base64(test::png(2, 2, kFour))}});
  const SurfaceColor color = mean_color(test::load_good(sketch), 0, kWhole);
  EXPECT_EQ(color.radiance, Rgb(0, 0.5, 0));
  EXPECT_EQ(color.albedo, Rgb(1.0));
}

/// Triangle 0 of area 1/2 and triangle 1 of area 3/2, of two materials, and a model of one cluster over half
/// of the first and all of the second.
struct TwoTriangles {
  Scene scene;
  Model model;

  TwoTriangles() {
    GltfSketch sketch = test::one_triangle();
    const int wide = sketch.add_floats({0, 0, 1, 3, 0, 1, 0, 1, 1}, "VEC3");
    sketch.add_mesh_node({{"attributes", {{"POSITION", wide}}}, {"material", 1}});
    sketch.json["meshes"][0]["primitives"][0]["material"] = 0;
    sketch.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {1.0, 0.2, 0.0, 1}}}}});
    sketch.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {0.3, 0.2, 0.0, 1}}}},
                             {"emissiveFactor", {0, 0, 1}}});
    scene = test::load_good(sketch);
    for (const auto& p : scene.vertices.positions) model.occluders.positions.emplace_back(p);
    model.occluders.triangles = scene.triangles;
    System system;
    system.pieces = {{0, {glm::vec2(0, 0), glm::vec2(0.5, 0), glm::vec2(0, 1)}}, {1, kWhole}};
    system.elements.resize(2);
    system.elements[0].piece_count = 1;
    system.elements[1].first_piece = 1;
    system.elements[1].piece_count = 1;
    system.clusters.resize(1);
    system.clusters[0].element_count = 2;
    model.systems.push_back(system);
  }
};

TEST(ClusterColors, AreAreaMeansClampedAndCounted) {
  const TwoTriangles two;
  const ClusterColors colors = cluster_colors(two.model, two.scene, 0.35);
  ASSERT_EQ(colors.albedo.size(), 1u);
  // Areas 1/4 and 3/2: red is (0.25 x 1.0 + 1.5 x 0.3) / 1.75 = 0.4, clamped to 0.35.
  EXPECT_NEAR(colors.albedo[0].x, 0.35, 1e-12);
  EXPECT_NEAR(colors.albedo[0].y, 0.2, 1e-12);
  EXPECT_EQ(colors.clamped_materials, 1u);
  EXPECT_NEAR(colors.exitance[0].z, kPi * 1.5 / 1.75, 1e-12);
  EXPECT_NEAR(cluster_colors(two.model, two.scene, 0.95).albedo[0].x, 0.4, 1e-12);
  EXPECT_EQ(cluster_colors(two.model, two.scene, 0.95).clamped_materials, 0u);
}

TEST(SurfaceOfTriangles, FollowsTheSurfaces) {
  const TwoTriangles two;
  EXPECT_EQ(surface_of_triangles(two.scene), (std::vector<std::uint32_t>{0, 1}));
}

}  // namespace
}  // namespace relume
