// SPDX-License-Identifier: MIT
#include "scene/scene_opacity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/gltf_sketch.h"
#include "scene/surface_color.h"

namespace relume {
namespace {

using test::GltfSketch;
using test::Json;

constexpr std::array<glm::vec2, 3> kWhole = {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)};

/// The triangle with a material and texture coordinates (0 0) (scale 0) (0 scale); vertices of alpha
/// `vertex_alpha`.
GltfSketch triangle(Json material, float scale = 1.0f, float vertex_alpha = 1.0f) {
  GltfSketch sketch = test::one_triangle();
  auto& primitive = sketch.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = sketch.add_floats({0, 0, scale, 0, 0, scale}, "VEC2");
  const float a = vertex_alpha;
  primitive["attributes"]["COLOR_0"] = sketch.add_floats({1, 1, 1, a, 1, 1, 1, a, 1, 1, 1, a}, "VEC4");
  primitive["material"] = sketch.add("materials", std::move(material));
  return sketch;
}

/// With a texture of `alpha`, row by row; colours white where solid and black where not.
GltfSketch textured(const char* mode, int width, const std::vector<std::uint8_t>& alpha, float scale = 1.0f) {
  GltfSketch sketch = triangle(
      {{"alphaMode", mode}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}, scale);
  std::vector<std::uint8_t> rgba;
  for (const std::uint8_t a : alpha) {
    const std::uint8_t level = a >= 128 ? 255 : 0;
    rgba.insert(rgba.end(), {level, level, level, a});
  }
  const auto bytes = test::png(width, int(alpha.size()) / width, rgba);
  sketch.add("images", {{"uri", "data:image/png;base64," + test::base64(bytes)}});
  sketch.add("textures", {{"source", 0}});
  return sketch;
}

float opacity_of(const GltfSketch& sketch, float u = 0.25f, float v = 0.25f) {
  const Opacity opacity = scene_opacity(test::load_good(sketch));
  return opacity.triangles.empty() ? 1.0f : opacity_at(opacity, opacity.triangles[0], u, v);
}

TEST(SceneOpacity, IsFactorTimesVertexColour) {
  const Json half = {{"baseColorFactor", {1, 1, 1, 0.5}}};
  EXPECT_FLOAT_EQ(opacity_of(triangle({{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", half}}, 1, 0.5f)),
                  0.25f);
  EXPECT_EQ(opacity_of(triangle({{"pbrMetallicRoughness", half}}, 1, 0.5f)), 1.0f) << "OPAQUE ignores alpha";
  EXPECT_EQ(opacity_of(triangle({{"alphaMode", "MASK"}, {"pbrMetallicRoughness", half}})), 1.0f)
      << "0.5 reaches 0.5";
  EXPECT_EQ(opacity_of(triangle({{"alphaMode", "MASK"}, {"pbrMetallicRoughness", half}}, 1, 0.5f)), 0.0f);
}

TEST(SceneOpacity, TransmissionPassesItsShareOfWhatAlphaLeaves) {
  const Json glass = {{"KHR_materials_transmission", {{"transmissionFactor", 0.75}}}};
  EXPECT_EQ(opacity_of(triangle({{"extensions", glass}})), 0.25f);
  EXPECT_EQ(opacity_of(triangle({{"extensions", glass}, {"alphaMode", "BLEND"}}, 1, 0.5f)), 0.125f);
  EXPECT_EQ(opacity_of(triangle({{"extensions", glass}, {"alphaMode", "MASK"}}, 1, 0.5f)), 0.25f);
}

TEST(SceneOpacity, SolidTrianglesAreNotListed) {
  EXPECT_TRUE(scene_opacity(test::load_good(triangle({{"alphaMode", "MASK"}}))).triangles.empty());
  EXPECT_TRUE(scene_opacity(test::load_good(textured("MASK", 2, {255, 200, 128, 255}))).maps.empty());
  // The triangle covers texels 0 to 4 of 8 in both directions; its neighbours may be met by rounding.
  const auto listed = [](std::size_t hole) {
    std::vector<std::uint8_t> alpha(64, 255);
    alpha[hole] = 0;
    return scene_opacity(test::load_good(textured("BLEND", 8, alpha, 0.5f))).triangles.size();
  };
  EXPECT_EQ(listed(8 * 6 + 6), 0u) << "a hole elsewhere in the image";
  EXPECT_EQ(listed(8 * 1 + 2), 1u);
}

TEST(SceneOpacity, HolesEverywhereHaveAlphaZero) {
  const Opacity opacity = scene_opacity(test::load_good(textured("MASK", 2, {0, 0, 0, 127})));
  ASSERT_EQ(opacity.triangles.size(), 1u);
  EXPECT_TRUE(never_solid(opacity, opacity.triangles[0]));
}

TEST(SceneOpacity, TexelsAreThoseOfTheImage) {
  // Row by row: s grows to the right, t downwards.
  const GltfSketch sketch = textured("BLEND", 2, {0, 51, 102, 255});
  EXPECT_EQ(opacity_of(sketch, 0.25f, 0.25f), 0.0f);
  EXPECT_EQ(opacity_of(sketch, 0.75f, 0.2f), 0.2f);
  EXPECT_EQ(opacity_of(sketch, 0.2f, 0.75f), 0.4f);
  // Coordinates twice as large repeat the image.
  EXPECT_EQ(opacity_of(textured("BLEND", 2, {0, 51, 102, 255}, 2.0f), 0.625f, 0.125f), 0.0f);
}

TEST(SceneOpacity, ColoursAreThoseOfTheSolidPart) {
  // White where solid, black where cut out: the solid part is white.
  const Scene scene = test::load_good(textured("MASK", 2, {255, 0, 0, 255}));
  const SurfaceColor color = mean_color(scene, 0, kWhole);
  EXPECT_EQ(color.albedo, Rgb(1.0));
  // The texel at the origin lies below the diagonal, half of each of its neighbours, none of the fourth: 1/4
  // of 1/2.
  EXPECT_NEAR(color.coverage, 0.5, 0.1) << "16 samples";
  // Blended: (1 x 1/2 + 0.4 x 0) over (1/2 + 0.4 / 2).
  const SurfaceColor blended =
      mean_color(test::load_good(textured("BLEND", 2, {255, 102, 102, 255})), 0, kWhole);
  EXPECT_NEAR(blended.coverage, 0.7, 0.06);
  EXPECT_NEAR(blended.albedo.x, 0.5 / 0.7, 0.1);
}

TEST(SceneOpacity, TheGeometryHashSeesAlphaAndNotColours) {
  const auto hash = [](const GltfSketch& sketch) { return geometry_hash(test::load_good(sketch)).total; };
  const GltfSketch leaf = textured("MASK", 2, {255, 0, 0, 255});
  EXPECT_EQ(hash(leaf), hash(leaf));
  EXPECT_NE(hash(leaf), hash(textured("MASK", 2, {255, 0, 255, 0}))) << "another hole";
  EXPECT_NE(hash(leaf), hash(textured("MASK", 2, {255, 0, 0, 255}, 0.9f))) << "coordinates moved";
  EXPECT_NE(hash(leaf), hash(textured("BLEND", 2, {255, 0, 0, 255})));
  GltfSketch painted = leaf;
  const auto red = test::png(2, 2, {255, 0, 0, 255, 9, 9, 9, 0, 1, 2, 3, 0, 200, 0, 0, 255});
  painted.json["images"][0]["uri"] = "data:image/png;base64," + test::base64(red);
  EXPECT_EQ(hash(leaf), hash(painted)) << "other colours under the same alpha";
  GltfSketch clear = leaf;
  clear.json["materials"][0]["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 0.5}}}};
  EXPECT_NE(hash(leaf), hash(clear));
}

TEST(SceneOpacity, WhatIsNotReadIsNamed) {
  GltfSketch sketch = triangle(
      {{"extensions",
        {{"KHR_materials_transmission", {{"transmissionFactor", 1}, {"transmissionTexture", {{"index", 0}}}}},
         {"KHR_materials_volume", {{"thicknessFactor", 0.1}}}}}});
  const Scene scene = test::load_good(sketch);
  EXPECT_EQ(scene.materials.at(0).transmission, 1.0);
  EXPECT_TRUE(test::warns(scene, "with a transmission texture, of which only the factor counts: 1"));
  EXPECT_TRUE(test::warns(scene, "KHR_materials_volume, treated as thin"));
  sketch.json["materials"][0]["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 1.5;
  const auto refused = test::load(sketch);
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message,
              testing::HasSubstr("/materials/0/extensions/KHR_materials_transmission/transmissionFactor"));
}

}  // namespace
}  // namespace relume
