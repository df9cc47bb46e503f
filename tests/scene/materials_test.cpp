// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/gltf_sketch.h"
#include "scene/load_scene.h"
#include "scene/surface_color.h"

namespace relume {
namespace {

using test::GltfSketch;
using test::Json;

constexpr std::array<glm::vec2, 3> kWhole = {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)};

/// The triangle with one material.
GltfSketch with_material(Json material) {
  GltfSketch sketch = test::one_triangle();
  sketch.add("materials", std::move(material));
  sketch.json["meshes"][0]["primitives"][0]["material"] = 0;
  return sketch;
}

TEST(Materials, FactorsAndFlags) {
  const Scene scene = test::load_good(with_material(
      {{"name", "wall"},
       {"pbrMetallicRoughness", {{"baseColorFactor", {0.25, 0.5, 0.75, 0.5}}, {"metallicFactor", 1.0}}},
       {"emissiveFactor", {0.1, 0.2, 0.4}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 100.0}}}}},
       {"doubleSided", true}}));
  const SceneMaterial& material = scene.materials.at(0);
  EXPECT_EQ(material.name, "wall");
  EXPECT_EQ(material.base_color, Rgb(0.25, 0.5, 0.75));
  EXPECT_EQ(material.alpha, 0.5);
  EXPECT_EQ(material.emission, Rgb(10.0, 20.0, 40.0));
  EXPECT_TRUE(material.double_sided);
  EXPECT_EQ(mean_color(scene, 0, kWhole).albedo, Rgb(0.25, 0.5, 0.75)) << "metallic does not darken";
  EXPECT_EQ(mean_color(scene, 0, kWhole).radiance, Rgb(10.0, 20.0, 40.0));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Materials, NoMaterialReflectsHalf) {
  const Scene scene = test::load_good(test::one_triangle());
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(mean_color(scene, 0, kWhole).albedo, Rgb(0.5));
  EXPECT_EQ(test::load_good(with_material({{"name", "white"}})).materials.at(0).base_color, Rgb(1.0))
      << "a material that says nothing is white";
}

TEST(Materials, UnlitNeitherBouncesNorEmits) {
  const Scene scene = test::load_good(with_material(
      {{"emissiveFactor", {1, 1, 1}}, {"extensions", {{"KHR_materials_unlit", Json::object()}}}}));
  EXPECT_TRUE(scene.materials.at(0).unlit);
  EXPECT_EQ(mean_color(scene, 0, kWhole).albedo, Rgb(0.0));
  EXPECT_EQ(mean_color(scene, 0, kWhole).radiance, Rgb(0.0));
}

TEST(Materials, NamesAreUnique) {
  GltfSketch sketch = test::one_triangle();
  for (const char* name : {"paint", "paint", "", "paint"}) {
    sketch.add("materials", std::string(name).empty() ? Json::object() : Json{{"name", name}});
  }
  const Scene scene = test::load_good(sketch);
  std::vector<std::string> names;
  for (const auto& material : scene.materials) names.push_back(material.name);
  EXPECT_THAT(names, testing::ElementsAre("paint", "paint#2", "material2", "paint#3", "no material"));
}

TEST(Materials, AlphaIsKept) {
  const Scene scene = test::load_good(with_material({{"alphaMode", "MASK"}, {"alphaCutoff", 0.25}}));
  EXPECT_EQ(scene.materials.at(0).alpha_mode, AlphaMode::mask);
  EXPECT_EQ(scene.materials.at(0).alpha_cutoff, 0.25);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Materials, ColoursOutsideTheirRangeAreClampedAndCounted) {
  GltfSketch sketch = with_material({{"pbrMetallicRoughness", {{"baseColorFactor", {-1, 0.5, 3, 1}}}}});
  sketch.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {9, 9, 9, 1}}}}});
  sketch.add("materials", {{"emissiveFactor", {-1, 2, 0}}});
  const Scene scene = test::load_good(sketch);
  EXPECT_EQ(scene.materials.at(0).base_color, Rgb(0.0, 0.5, 1.0));
  EXPECT_EQ(scene.materials.at(2).emission, Rgb(0.0, 2.0, 0.0));
  EXPECT_TRUE(test::warns(scene, "a base colour outside 0 to 1, clamped: 2"));
  EXPECT_TRUE(test::warns(scene, "set to 0: 1"));
}

/// The triangle with a texture; `image` is an element of /images.
GltfSketch with_image(Json image) {
  GltfSketch sketch = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  sketch.add("textures", {{"source", 0}});
  sketch.add("images", std::move(image));
  return sketch;
}

TEST(Materials, ImagesComeFromDataUrisAndViews) {
  const test::Bytes red = test::png(1, 1, {255, 0, 0, 255});
  const Scene from_uri = test::load_good(with_image({{"uri", "data:image/png;base64," + test::base64(red)}}));
  ASSERT_EQ(from_uri.images.size(), 1u);
  EXPECT_THAT(from_uri.images[0].rgba, testing::ElementsAre(255, 0, 0, 255));
  EXPECT_TRUE(test::warns(from_uri, "with a texture but without its coordinates"));

  GltfSketch in_view = with_image(Json::object());
  const int view = in_view.add_view(red.data(), red.size());
  in_view.json["images"][0] = {{"bufferView", view}, {"mimeType", "image/png"}};
  EXPECT_THAT(test::load_good(in_view).images.at(0).rgba, testing::ElementsAre(255, 0, 0, 255));
}

TEST(Materials, ImagesThatCannotBeReadAreRefusedWithTheirPlace) {
  const test::Bytes red = test::png(1, 1, {255, 0, 0, 255});
  const std::string cut = test::base64({red.begin(), red.begin() + 40});
  for (const Json& image : {Json{{"uri", "gone.png"}}, Json{{"uri", "data:image/png;base64," + cut}},
                            Json{{"uri", "data:image/webp;base64,UklGRg=="}}, Json::object()}) {
    const auto refused = test::load(with_image(image));
    ASSERT_FALSE(refused.has_value()) << image;
    EXPECT_THAT(refused.error().message, testing::HasSubstr("/images/0")) << image;
  }
}

TEST(Materials, HugeImagesAreRefusedBeforeTheyAreDecoded) {
  const test::Bytes picture = test::png(8, 4, std::vector<std::uint8_t>(8 * 4 * 4, 9));
  const GltfSketch sketch = with_image({{"uri", "data:image/png;base64," + test::base64(picture)}});
  const test::ScratchFolder folder;
  SceneLimits limits;
  limits.max_image_pixels = 31;
  const auto refused = load_scene(sketch.write(folder), limits);
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, testing::HasSubstr("at most 31 pixels, found 8 x 4"));
}

TEST(Materials, ImagesThatNoColourNeedsAreNotOpened) {
  GltfSketch sketch = with_material({{"normalTexture", {{"index", 0}}}});
  sketch.add("textures", {{"source", 0}});
  sketch.add("images", {{"uri", "gone.png"}});
  EXPECT_TRUE(test::load_good(sketch).images.empty());
}

TEST(Materials, UnknownExtensionsAreNamed) {
  GltfSketch sketch = test::one_triangle();
  sketch.json["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_texture_transform"};
  const Scene scene = test::load_good(sketch);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_THAT(scene.warnings[0], testing::HasSubstr("KHR_materials_clearcoat"));
}

}  // namespace
}  // namespace relume
