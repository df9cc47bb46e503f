// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <glm/geometric.hpp>

#include "scene/gltf_sketch.h"

namespace relume {
namespace {

using test::GltfSketch;
using test::Json;

const std::vector<float> kSquare = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};  // counter-clockwise seen from +Z

/// The square as one primitive of a mode, with indices in one component type.
template <class T>
GltfSketch square(int mode, const std::vector<T>& indices, int component_type) {
  GltfSketch sketch;
  const int positions = sketch.add_floats(kSquare, "VEC3");
  const int corners = sketch.add_accessor(indices, component_type, "SCALAR", indices.size());
  sketch.add_mesh_node({{"attributes", {{"POSITION", positions}}}, {"indices", corners}, {"mode", mode}});
  return sketch;
}

/// Two triangles of area 1/2 that look along +Z.
void expect_unit_square(const Scene& scene) {
  ASSERT_EQ(scene.triangles.size(), 2u);
  EXPECT_EQ(test::triangle_normal(scene, 0), glm::dvec3(0, 0, 1));
  EXPECT_EQ(test::triangle_normal(scene, 1), glm::dvec3(0, 0, 1));
}

TEST(Primitives, TrianglesStripsAndFansKeepTheirFronts) {
  expect_unit_square(test::load_good(square<std::uint16_t>(4, {0, 1, 2, 0, 2, 3}, test::kUnsignedShort)));
  expect_unit_square(test::load_good(square<std::uint16_t>(5, {0, 1, 3, 2}, test::kUnsignedShort)));
  expect_unit_square(test::load_good(square<std::uint16_t>(6, {0, 1, 2, 3}, test::kUnsignedShort)));
}

TEST(Primitives, EveryIndexTypeIsRead) {
  expect_unit_square(test::load_good(square<std::uint8_t>(4, {0, 1, 2, 0, 2, 3}, test::kUnsignedByte)));
  expect_unit_square(test::load_good(square<std::uint32_t>(4, {0, 1, 2, 0, 2, 3}, test::kUnsignedInt)));
}

TEST(Primitives, WithoutIndicesVerticesFollowEachOther) {
  GltfSketch sketch;
  const int positions = sketch.add_floats(kSquare, "VEC3");
  sketch.add_mesh_node({{"attributes", {{"POSITION", positions}}}, {"mode", 6}});
  expect_unit_square(test::load_good(sketch));
}

TEST(Primitives, PointsAndLinesAreSkippedWithAWarning) {
  for (const int mode : {0, 1, 2, 3}) {
    const Scene scene = test::load_good(square<std::uint16_t>(mode, {0, 1, 2, 3}, test::kUnsignedShort));
    EXPECT_TRUE(scene.triangles.empty());
    EXPECT_TRUE(test::warns(scene, "primitives of points or lines, skipped: 1")) << mode;
  }
}

TEST(Primitives, InterleavedVerticesAreTakenApart) {
  struct Vertex {
    float position[3];
    float uv[2];
  };
  const std::vector<Vertex> vertices = {
      {{0, 0, 0}, {0.1f, 0.2f}}, {{2, 0, 0}, {0.3f, 0.4f}}, {{0, 3, 0}, {0.5f, 0.6f}}};
  GltfSketch sketch;
  const int view = sketch.add_view(vertices.data(), sizeof(Vertex) * 3, {{"byteStride", sizeof(Vertex)}});
  const Json shared = {{"bufferView", view}, {"componentType", test::kFloat}, {"count", 3}};
  Json positions = shared;
  positions["type"] = "VEC3";
  Json uvs = shared;
  uvs["type"] = "VEC2";
  uvs["byteOffset"] = 12;
  const int at_positions = sketch.add("accessors", positions);
  const int at_uvs = sketch.add("accessors", uvs);
  sketch.add_mesh_node({{"attributes", {{"POSITION", at_positions}, {"TEXCOORD_1", at_uvs}}}});
  const Scene scene = test::load_good(sketch);
  EXPECT_EQ(test::triangle_normal(scene, 0), glm::dvec3(0, 0, 6));
  EXPECT_TRUE(scene.surfaces.at(0).has_uv1);
  EXPECT_FALSE(scene.surfaces.at(0).has_uv0);
  EXPECT_EQ(scene.vertices.uv1.at(2), glm::vec2(0.5f, 0.6f));
}

TEST(Primitives, SparseValuesReplaceSomeElements) {
  GltfSketch sketch = test::one_triangle();
  const std::vector<std::uint16_t> indices = {2};
  const std::vector<float> values = {0, 5, 0};
  const int at_indices = sketch.add_view(indices.data(), 2);
  const int at_values = sketch.add_view(values.data(), 12);
  sketch.json["accessors"][0]["sparse"] = {{"count", 1},
                                           {"indices", {{"bufferView", at_indices}, {"componentType", 5123}}},
                                           {"values", {{"bufferView", at_values}}}};
  EXPECT_EQ(test::triangle_normal(test::load_good(sketch), 0), glm::dvec3(0, 0, 5));
}

TEST(Primitives, QuantizedPositionsAreIntegersOrNormalised) {
  const std::vector<std::int16_t> positions = {0, 0, 0,      0,     32767, 0,
                                               0, 0, -32768, 32767, 0,     0};  // padded to 8 bytes
  for (const bool normalised : {true, false}) {
    GltfSketch sketch;
    const int view = sketch.add_view(positions.data(), 24, {{"byteStride", 8}});
    const int at = sketch.add("accessors", {{"bufferView", view},
                                            {"componentType", test::kShort},
                                            {"normalized", normalised},
                                            {"type", "VEC3"},
                                            {"count", 3}});
    sketch.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    sketch.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    sketch.add_mesh_node({{"attributes", {{"POSITION", at}}}});
    const Scene scene = test::load_good(sketch);
    const double unit = normalised ? 1.0 : 32767.0;
    const auto p = test::corners(scene, 0);
    EXPECT_EQ(p[1], glm::dvec3(unit, 0, 0));
    EXPECT_EQ(p[2].x, normalised ? -1.0 : -32768.0) << "normalised values stop at -1";
    EXPECT_EQ(p[2].y, unit);
    EXPECT_TRUE(scene.warnings.empty());
  }
}

TEST(Primitives, CompressedViewsAreDecodedAndTheFallbackIsNotAskedFor) {
  const std::vector<std::uint32_t> indices = {0, 1, 2, 0, 2, 3};
  std::vector<unsigned char> packed(meshopt_encodeIndexBufferBound(6, 4));
  packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), 6));
  GltfSketch sketch;
  const int positions = sketch.add_floats(kSquare, "VEC3");
  const int at_packed = sketch.add_view(packed.data(), packed.size());
  const Json placed = sketch.json["bufferViews"][static_cast<std::size_t>(at_packed)];
  const int unpacked = sketch.add("bufferViews", {{"buffer", 1},
                                                  {"byteLength", 24},
                                                  {"extensions",
                                                   {{"EXT_meshopt_compression",
                                                     {{"buffer", 0},
                                                      {"byteOffset", placed["byteOffset"]},
                                                      {"byteLength", packed.size()},
                                                      {"byteStride", 4},
                                                      {"count", 6},
                                                      {"mode", "TRIANGLES"}}}}}});
  sketch.json["buffers"] = {
      {{"byteLength", sketch.binary.size()}, {"uri", "data.bin"}},
      {{"byteLength", 24}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  sketch.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  const int corners = sketch.add(
      "accessors",
      {{"bufferView", unpacked}, {"componentType", test::kUnsignedInt}, {"type", "SCALAR"}, {"count", 6}});
  sketch.add_mesh_node({{"attributes", {{"POSITION", positions}}}, {"indices", corners}});
  expect_unit_square(test::load_good(sketch));

  sketch.binary[placed["byteOffset"].get<std::size_t>()] = std::byte{0};  // not the codec's header
  const auto refused = test::load(sketch);
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message,
              testing::HasSubstr("/bufferViews/2/extensions/EXT_meshopt_compression"));
}

TEST(Primitives, FilteredPositionsAreDecoded) {
  const std::vector<float> said = {0, 0, 0, 3, 0, 0, 0, -0.625f, 0};  // few bits: the filter keeps them whole
  std::vector<std::uint32_t> filtered(9);
  meshopt_encodeFilterExp(filtered.data(), 3, 12, 15, said.data());
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(3, 12));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), filtered.data(), 3, 12));
  GltfSketch sketch;
  const int at_packed = sketch.add_view(packed.data(), packed.size());
  sketch.json["bufferViews"][static_cast<std::size_t>(at_packed)]["byteLength"] = 36;
  sketch.json["bufferViews"][static_cast<std::size_t>(at_packed)]["buffer"] = 1;
  sketch.json["bufferViews"][static_cast<std::size_t>(at_packed)]["extensions"]["EXT_meshopt_compression"] = {
      {"buffer", 0}, {"byteLength", packed.size()}, {"byteStride", 12},
      {"count", 3},  {"mode", "ATTRIBUTES"},        {"filter", "EXPONENTIAL"}};
  sketch.json["buffers"] = {{{"byteLength", packed.size()}, {"uri", "data.bin"}}, {{"byteLength", 36}}};
  const int positions = sketch.add(
      "accessors",
      {{"bufferView", at_packed}, {"componentType", test::kFloat}, {"type", "VEC3"}, {"count", 3}});
  sketch.add_mesh_node({{"attributes", {{"POSITION", positions}}}});
  const auto p = test::corners(test::load_good(sketch), 0);
  EXPECT_EQ(p[1], glm::dvec3(3, 0, 0));
  EXPECT_EQ(p[2], glm::dvec3(0, -0.625, 0));
}

TEST(Primitives, MirroredNodesKeepTheirFronts) {
  for (const Json& scale : {Json{-1, 1, 1}, Json{1, -1, 1}, Json{-1, -1, -1}}) {
    // Mirroring in the plane of the triangle turns it over: its front still looks where the transform takes
    // +Z.
    const Scene scene = test::load_good(test::one_triangle({{"scale", scale}}));
    const double z = scale[2].get<double>();
    EXPECT_EQ(test::triangle_normal(scene, 0), glm::dvec3(0, 0, z)) << scale;
  }
  const Scene twice = test::load_good(test::one_triangle({{"scale", {-1, -1, 1}}}));
  EXPECT_EQ(test::triangle_normal(twice, 0), glm::dvec3(0, 0, 1));
}

TEST(Primitives, MorphTargetsGiveTheBaseShapeWithAWarning) {
  GltfSketch sketch = test::one_triangle();
  const int target = sketch.add_floats({9, 9, 9, 9, 9, 9, 9, 9, 9}, "VEC3");
  sketch.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", target}}};
  sketch.json["meshes"][0]["weights"] = {1.0};
  const Scene scene = test::load_good(sketch);
  EXPECT_EQ(test::triangle_normal(scene, 0), glm::dvec3(0, 0, 1));
  EXPECT_TRUE(test::warns(scene, "only the base shape was read: 1"));
}

TEST(Primitives, VertexColoursMayBeBytesAndAreClamped) {
  GltfSketch sketch = test::one_triangle();
  const std::vector<std::uint8_t> bytes = {255, 0, 51, 255, 0, 255, 0, 0, 0, 0, 0, 0};
  const int at = sketch.add_accessor(bytes, test::kUnsignedByte, "VEC4", 3, {{"normalized", true}});
  sketch.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = at;
  const Scene scene = test::load_good(sketch);
  EXPECT_EQ(scene.vertices.colors.at(0), glm::vec4(1.0f, 0.0f, 0.2f, 1.0f));

  GltfSketch bright = test::one_triangle();
  const int floats = bright.add_floats({2, 0.5, -1, 0, 0, 0, 0, 0, 0}, "VEC3");
  bright.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = floats;
  const Scene clamped = test::load_good(bright);
  EXPECT_EQ(clamped.vertices.colors.at(0), glm::vec4(1.0f, 0.5f, 0.0f, 1.0f));
  EXPECT_TRUE(test::warns(clamped, "vertex colours outside 0 to 1"));
}

TEST(Primitives, TrianglesWithoutUseAreDroppedInOneWarning) {
  GltfSketch sketch;
  const int positions = sketch.add_floats(kSquare, "VEC3");
  // One good, one of a repeated corner, the good one again from another corner, and its back side, which is
  // no repetition.
  const std::vector<std::uint16_t> corners = {0, 1, 2, 0, 1, 1, 1, 2, 0, 2, 1, 0};
  const int indices = sketch.add_accessor(corners, test::kUnsignedShort, "SCALAR", corners.size());
  sketch.add_mesh_node({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  const Scene scene = test::load_good(sketch);
  EXPECT_EQ(scene.triangles.size(), 2u);
  EXPECT_EQ(scene.dropped.without_area, 1u);
  EXPECT_EQ(scene.dropped.repeated, 1u);
  EXPECT_EQ(scene.vertices.positions.size(), 3u) << "the fourth vertex is of no use";
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_THAT(scene.warnings[0],
              testing::HasSubstr("dropped triangles: 1 without area, 1 repeated, 0 not finite"));
}

TEST(Primitives, TrianglesBeyondAllReachAreDropped) {
  const Scene scene = test::load_good(test::one_triangle({{"scale", {1e30, 1e30, 1e30}}}));
  EXPECT_TRUE(scene.triangles.empty());
  EXPECT_TRUE(scene.vertices.positions.empty());
  EXPECT_EQ(scene.dropped.not_finite, 1u);
}

TEST(Primitives, AFlatScaleLeavesNoArea) {
  const Scene scene = test::load_good(test::one_triangle({{"scale", {0, 1, 1}}}));
  EXPECT_TRUE(scene.triangles.empty());
  EXPECT_EQ(scene.dropped.without_area, 1u);
}

}  // namespace
}  // namespace relume
