// SPDX-License-Identifier: MIT
//
// Every byte of two small files changed, and every truncation: the importer ends with a scene that keeps its
// promises, or with one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scene/generate_scene.h"
#include "scene/gltf_sketch.h"
#include "scene/load_scene.h"
#include "scene/surface_color.h"
#include "support/repeats.h"

namespace relume {
namespace {

/// Some others, or all of them where the environment says so.
std::string other_values(char byte) {
  if (test::repeats("RELUME_BYTE_VALUES", 3) < 255) return {char(byte ^ 1), char(byte ^ 0x80), '9'};
  std::string values;
  for (int difference = 1; difference < 256; ++difference) values += char(byte ^ difference);
  return values;
}

/// Loads bytes as a file and checks what comes back.
class Mutations : public testing::Test {
 protected:
  void check(const std::string& name, const std::string& bytes) {
    const auto scene = load_scene(folder_.write(name, bytes));
    if (!scene) {
      ++refused_;
      EXPECT_EQ(scene.error().message.find('\n'), std::string::npos) << scene.error().message;
      EXPECT_THAT(scene.error().message, testing::HasSubstr(name));
      return;
    }
    ++loaded_;
    for (const auto& position : scene->vertices.positions) {
      ASSERT_TRUE(std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z));
    }
    for (const auto& triangle : scene->triangles) {
      for (const std::uint32_t corner : triangle) ASSERT_LT(corner, scene->vertices.positions.size());
    }
    for (std::uint32_t t = 0; t < scene->triangles.size(); ++t) {
      const Rgb albedo = mean_color(*scene, t, {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)}).albedo;
      for (int c = 0; c < 3; ++c) ASSERT_TRUE(albedo[c] >= 0.0 && albedo[c] <= 1.0) << albedo[c];
    }
    for (const auto& light : scene->lights) ASSERT_TRUE(std::isfinite(light.intensity.x));
  }

  void check_all(const std::string& name, const std::string& good) {
    check(name, good);
    ASSERT_EQ(loaded_, 1) << "the unchanged file must load";
    for (std::size_t i = 0; i < good.size(); ++i) {
      for (const char value : other_values(good[i])) {
        std::string bytes = good;
        bytes[i] = value;
        check(name, bytes);
      }
      check(name, good.substr(0, i));
    }
    EXPECT_GT(refused_, static_cast<int>(good.size())) << "truncations and broken keys must be seen";
    EXPECT_GT(loaded_, 10) << "some changes are harmless";
  }

  test::ScratchFolder folder_;
  int loaded_ = 0;
  int refused_ = 0;
};

TEST_F(Mutations, OfAGltf) {
  test::GltfSketch sketch = test::one_triangle({{"name", "n"}, {"rotation", {0, 0, 0, 1}}});
  const int uv = sketch.add_floats({0, 0, 1, 0, 0, 1}, "VEC2");
  auto& primitive = sketch.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = uv;
  primitive["material"] =
      sketch.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  sketch.add("textures", {{"source", 0}});
  sketch.add("images",
             {{"uri", "data:image/png;base64," + test::base64(test::png(1, 1, {9, 99, 199, 255}))}});
  sketch.json["buffers"] = {{{"byteLength", sketch.binary.size()},
                             {"uri", "data:application/octet-stream;base64," + test::base64(sketch.binary)}}};
  check_all("mutated.gltf", sketch.json.dump());
}

TEST_F(Mutations, OfAGlb) {
  auto sketch = generate_scene("light_plane");
  ASSERT_TRUE(sketch.has_value());
  Light light;
  light.type = LightType::spot;
  add_light(*sketch, light);
  const auto bytes = encode_glb(*sketch);
  ASSERT_TRUE(bytes.has_value());
  check_all("mutated.glb", std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()));
}

}  // namespace
}  // namespace relume
