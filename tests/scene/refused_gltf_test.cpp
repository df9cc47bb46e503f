// SPDX-License-Identifier: MIT
//
// One broken property at a time in an otherwise good file: refused, with the place named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "scene/gltf_sketch.h"
#include "scene/load_scene.h"

namespace relume {
namespace {

using test::GltfSketch;
using test::Json;
using testing::HasSubstr;

struct Case {
  const char* place;
  std::function<void(GltfSketch&)> breaks;
};

/// A triangle with indices, a material, a texture without image, an animation, a skin, a camera and a light.
GltfSketch rich() {
  GltfSketch sketch = test::one_triangle();
  const std::vector<std::uint16_t> indices = {0, 1, 2};
  sketch.json["meshes"][0]["primitives"][0]["indices"] =
      sketch.add_accessor(indices, test::kUnsignedShort, "SCALAR", 3);
  sketch.json["meshes"][0]["primitives"][0]["material"] = sketch.add("materials", {{"name", "m"}});
  sketch.add("nodes", {{"name", "spare"}});
  return sketch;
}

void expect_refused(const Case& broken) {
  GltfSketch sketch = rich();
  broken.breaks(sketch);
  const auto scene = test::load(sketch);
  ASSERT_FALSE(scene.has_value()) << broken.place;
  EXPECT_EQ(scene.error().code, ErrorCode::bad_input) << broken.place;
  EXPECT_THAT(scene.error().message, testing::StartsWith("scene.gltf: "));
  EXPECT_THAT(scene.error().message, HasSubstr(std::string(broken.place)));
  EXPECT_THAT(scene.error().message, HasSubstr(": expected "));
  EXPECT_THAT(scene.error().message, HasSubstr(", found "));
}

TEST(RefusedGltf, TheUnbrokenFileLoads) {
  EXPECT_EQ(test::load_good(rich()).triangles.size(), 1u);
}

TEST(RefusedGltf, WrongTypes) {
  expect_refused({"/asset", [](auto& s) { s.json.erase("asset"); }});
  expect_refused({"/asset/version", [](auto& s) { s.json["asset"]["version"] = 2; }});
  expect_refused({"/nodes", [](auto& s) { s.json["nodes"] = {{"mesh", 0}}; }});
  expect_refused({"/nodes/0", [](auto& s) { s.json["nodes"][0] = "node"; }});
  expect_refused({"/nodes/0/mesh", [](auto& s) { s.json["nodes"][0]["mesh"] = "0"; }});
  expect_refused({"/nodes/0/mesh", [](auto& s) { s.json["nodes"][0]["mesh"] = 0.5; }});
  expect_refused({"/nodes/0/mesh", [](auto& s) { s.json["nodes"][0]["mesh"] = -1; }});
  expect_refused({"/nodes/0/name", [](auto& s) { s.json["nodes"][0]["name"] = {1}; }});
  expect_refused(
      {"/nodes/0/matrix", [](auto& s) { s.json["nodes"][0]["matrix"] = std::vector<int>(15, 1); }});
  expect_refused({"/nodes/0/scale", [](auto& s) { s.json["nodes"][0]["scale"] = {1, 1, "1"}; }});
  expect_refused({"/nodes/0/extras/relume/static",
                  [](auto& s) { s.json["nodes"][0]["extras"]["relume"]["static"] = 1; }});
  expect_refused({"/nodes/0/extras/relume/receiver",
                  [](auto& s) { s.json["nodes"][0]["extras"]["relume"]["receiver"] = "lightmaps"; }});
  expect_refused({"/nodes/0/extras/relume/texel_size",
                  [](auto& s) { s.json["nodes"][0]["extras"]["relume"]["texel_size"] = 0; }});
  for (const auto& [key, value] : std::vector<std::pair<std::string, Json>>{{"texel_size", -1},
                                                                            {"system", 3},
                                                                            {"quality", 7},
                                                                            {"quality", 64.5},
                                                                            {"quality", (1 << 20) + 1},
                                                                            {"budget", 0},
                                                                            {"budget", "many"},
                                                                            {"emitter", "yes"},
                                                                            {"receiver", "foo"}}) {
    expect_refused({("/nodes/0/extras/relume/" + key).c_str(),
                    [&, k = key, v = value](auto& s) { s.json["nodes"][0]["extras"]["relume"][k] = v; }});
  }
  expect_refused({"/materials/0/alphaMode", [](auto& s) { s.json["materials"][0]["alphaMode"] = "CUTOUT"; }});
  expect_refused({"/materials/0/emissiveFactor", [](auto& s) {
                    s.json["materials"][0]["emissiveFactor"] = {1, 1};
                  }});
  expect_refused(
      {"/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", [](auto& s) {
         s.json["materials"][0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = -2;
       }});
}

TEST(RefusedGltf, IndicesThatPointNowhere) {
  expect_refused({"/scene", [](auto& s) { s.json["scene"] = 1; }});
  expect_refused({"/scenes/0/nodes/0", [](auto& s) { s.json["scenes"][0]["nodes"][0] = 9; }});
  expect_refused({"/nodes/0/children/0", [](auto& s) { s.json["nodes"][0]["children"] = {2}; }});
  expect_refused({"/nodes/0/mesh", [](auto& s) { s.json["nodes"][0]["mesh"] = 1; }});
  expect_refused({"/nodes/0/camera", [](auto& s) { s.json["nodes"][0]["camera"] = 0; }});
  expect_refused({"/nodes/0/skin", [](auto& s) { s.json["nodes"][0]["skin"] = 0; }});
  expect_refused({"/nodes/0/extensions/KHR_lights_punctual/light",
                  [](auto& s) { s.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; }});
  expect_refused({"/meshes/0/primitives/0/attributes/POSITION",
                  [](auto& s) { s.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 77; }});
  expect_refused({"/meshes/0/primitives/0/material",
                  [](auto& s) { s.json["meshes"][0]["primitives"][0]["material"] = 5; }});
  expect_refused({"/accessors/0/bufferView", [](auto& s) { s.json["accessors"][0]["bufferView"] = 2; }});
  expect_refused({"/bufferViews/0/buffer", [](auto& s) {
                    s.json["buffers"] = {{{"byteLength", s.binary.size()}, {"uri", "data.bin"}}};
                    s.json["bufferViews"][0]["buffer"] = 1;
                  }});
  expect_refused({"/materials/0/pbrMetallicRoughness/baseColorTexture/index", [](auto& s) {
                    s.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
                  }});
  expect_refused({"/animations/0/channels/0/target/node", [](auto& s) {
                    s.json["animations"] = {
                        {{"channels", {{{"sampler", 0}, {"target", {{"node", 8}, {"path", "scale"}}}}}}}};
                  }});
}

TEST(RefusedGltf, OffsetsAndCountsThatDoNotFit) {
  expect_refused({"/accessors/0/count", [](auto& s) { s.json["accessors"][0]["count"] = 0; }});
  expect_refused({"/accessors/0/count", [](auto& s) { s.json["accessors"][0]["count"] = 4000000000u; }});
  expect_refused({"/accessors/0", [](auto& s) { s.json["accessors"][0]["count"] = 4; }});
  expect_refused({"/accessors/0", [](auto& s) { s.json["accessors"][0]["byteOffset"] = 4; }});
  expect_refused({"/accessors/0/byteOffset", [](auto& s) { s.json["accessors"][0]["byteOffset"] = -4; }});
  // 2^64 - 4 and 2^53 + something: sums that wrap in 64 bits, or lose digits in a double.
  expect_refused({"/bufferViews/0/byteOffset",
                  [](auto& s) { s.json["bufferViews"][0]["byteOffset"] = 18446744073709551612ull; }});
  expect_refused(
      {"/bufferViews/0", [](auto& s) { s.json["bufferViews"][0]["byteOffset"] = 9007199254740992ull; }});
  expect_refused({"/bufferViews/0", [](auto& s) { s.json["bufferViews"][0]["byteLength"] = 1000; }});
  expect_refused({"/bufferViews/0/byteStride", [](auto& s) { s.json["bufferViews"][0]["byteStride"] = 13; }});
  expect_refused(
      {"/bufferViews/0/byteStride", [](auto& s) { s.json["bufferViews"][0]["byteStride"] = 256; }});
  expect_refused({"/accessors/0", [](auto& s) { s.json["bufferViews"][0]["byteStride"] = 16; }});
  expect_refused({"/buffers/0/byteLength", [](auto& s) {
                    s.json["buffers"] = {{{"byteLength", 0}, {"uri", "data.bin"}}};
                  }});
  expect_refused({"/buffers/0/byteLength", [](auto& s) {
                    s.json["buffers"] = {{{"byteLength", 1 << 20}, {"uri", "data.bin"}}};
                  }});
  expect_refused({"/buffers/0", [](auto& s) { s.json["buffers"] = {{{"byteLength", s.binary.size()}}}; }});
}

TEST(RefusedGltf, SparsePartsThatDoNotFit) {
  const auto sparse = [](GltfSketch& s, int count, std::uint16_t index, std::size_t value_offset) {
    const int indices = s.add_view(&index, 2);
    const std::vector<float> value = {0, 0, 0};
    const int values = s.add_view(value.data(), 12);
    s.json["accessors"][0]["sparse"] = {{"count", count},
                                        {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                        {"values", {{"bufferView", values}, {"byteOffset", value_offset}}}};
  };
  expect_refused({"/accessors/0/sparse/count", [&](auto& s) { sparse(s, 4, 0, 0); }});
  expect_refused({"/accessors/0/sparse/indices", [&](auto& s) { sparse(s, 2, 0, 0); }});
  expect_refused({"/accessors/0/sparse/values", [&](auto& s) { sparse(s, 1, 0, 4); }});
  expect_refused({"POSITION, sparse index 0", [&](auto& s) { sparse(s, 1, 3, 0); }});
}

TEST(RefusedGltf, AttributesOfTheWrongKind) {
  expect_refused({"/meshes/0/primitives/0/attributes/POSITION",
                  [](auto& s) { s.json["accessors"][0]["type"] = "VEC2"; }});
  expect_refused({"/meshes/0/primitives/0/attributes/POSITION",
                  [](auto& s) { s.json["accessors"][0]["componentType"] = 5125; }});
  expect_refused(
      {"/meshes/0/primitives/0/indices", [](auto& s) { s.json["accessors"][1]["componentType"] = 5122; }});
  expect_refused(
      {"/meshes/0/primitives/0/indices", [](auto& s) { s.json["accessors"][1].erase("bufferView"); }});
  expect_refused(
      {"/meshes/0/primitives/0/attributes/TEXCOORD_0", [](auto& s) {
         s.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = s.add_floats({0, 0}, "VEC2");
       }});
  expect_refused({"/meshes/0/primitives/0/attributes/POSITION", [](auto& s) {
                    s.json["accessors"][0].erase("bufferView");
                    s.json["accessors"][0]["count"] = 1 << 30;  // zeros that cost the file nothing
                  }});
  expect_refused({"POSITION, element 1", [](auto& s) {
                    const float infinite = std::numeric_limits<float>::infinity();
                    std::memcpy(s.binary.data() + 16, &infinite, 4);
                  }});
}

TEST(RefusedGltf, NodesThatAreNoForest) {
  expect_refused({"/nodes/0", [](auto& s) { s.json["nodes"][0]["children"] = {0}; }});
  expect_refused({"/nodes/1/children/0", [](auto& s) {
                    s.json["nodes"].push_back({{"name", "third"}});
                    s.json["nodes"][0]["children"] = {2};
                    s.json["nodes"][1]["children"] = {2};
                  }});
  expect_refused({"/nodes/0/children/1", [](auto& s) { s.json["nodes"][0]["children"] = {1, 1}; }});
  expect_refused({"/scenes/0/nodes/1", [](auto& s) { s.json["scenes"][0]["nodes"] = {0, 0}; }});
  expect_refused({"/scenes/0/nodes/1", [](auto& s) {
                    s.json["nodes"][0]["children"] = {1};
                    s.json["scenes"][0]["nodes"] = {0, 1};
                  }});
}

TEST(RefusedGltf, VersionsAndExtensionsThatAreNotRead) {
  expect_refused({"/asset/version", [](auto& s) { s.json["asset"]["version"] = "1.0"; }});
  expect_refused({"/asset/minVersion", [](auto& s) { s.json["asset"]["minVersion"] = "3.0"; }});
  expect_refused(
      {"/extensionsRequired/0", [](auto& s) { s.json["extensionsRequired"] = {"EXT_of_tomorrow"}; }});
}

TEST(RefusedGltf, CamerasWithoutTheirLens) {
  expect_refused({"/cameras/0/perspective", [](auto& s) {
                    s.json["cameras"] = {{{"type", "perspective"}}};
                  }});
  expect_refused({"/cameras/0/perspective/yfov", [](auto& s) {
                    s.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"znear", 1}}}}};
                  }});
}

TEST(RefusedGltf, DeepJsonIsRefusedBeforeItIsParsed) {
  const test::ScratchFolder folder;
  const auto refused = load_scene(folder.write("deep.gltf", std::string(100000, '[')));
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, HasSubstr("deep.gltf: byte 64: expected JSON nested at most 64 deep"));
  // Brackets in strings do not nest.
  GltfSketch sketch = rich();
  sketch.json["asset"]["copyright"] = std::string(1000, '[') + "\"\\";
  EXPECT_EQ(test::load_good(sketch).triangles.size(), 1u);
}

TEST(RefusedGltf, JsonAboveItsLimit) {
  const test::ScratchFolder folder;
  SceneLimits limits;
  limits.max_json_bytes = 10;
  const auto refused = load_scene(rich().write(folder), limits);
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, HasSubstr("at most 10 bytes of JSON"));
}

TEST(RefusedGltf, BrokenContainers) {
  const test::ScratchFolder folder;
  const auto message = [&](const std::string& bytes) {
    const auto scene = load_scene(folder.write("a.glb", bytes));
    return scene ? std::string("loaded") : scene.error().message;
  };
  const auto word = [](std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
  const std::string json = R"({"asset":{"version":"2.0"}}     )";
  ASSERT_EQ(json.size(), 32u);
  const std::string chunk = word(32) + "JSON" + json;
  EXPECT_EQ(message("glTF" + word(2) + word(52) + chunk), "loaded");
  EXPECT_THAT(message("glTF" + word(1) + word(52) + chunk),
              HasSubstr("byte 4: expected GLB version 2, found 1"));
  EXPECT_THAT(message("glTF" + word(2) + word(53) + chunk), HasSubstr("byte 8"));
  EXPECT_THAT(message("glTF" + word(2) + word(20) + chunk), HasSubstr("byte 12"));
  EXPECT_THAT(message("glTF" + word(2) + word(52) + word(0xffffffff) + "JSON" + json), HasSubstr("byte 12"));
  EXPECT_THAT(message("glTF" + word(2) + word(52) + word(32) + "JSOX" + json), HasSubstr("byte 16"));
  EXPECT_THAT(message("glTF" + word(2) + word(56) + chunk + "BIN1"), HasSubstr("byte 52"));
}

TEST(RefusedGltf, BytesAfterTheContainerAreWarnedAbout) {
  const test::ScratchFolder folder;
  const auto word = [](std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
  const std::string glb =
      "glTF" + word(2) + word(52) + word(32) + "JSON" + R"({"asset":{"version":"2.0"}}     )";
  const auto scene = load_scene(folder.write("a.glb", glb + "garbage"));
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  EXPECT_TRUE(test::warns(*scene, "7 bytes after the end"));
}

}  // namespace
}  // namespace relume
