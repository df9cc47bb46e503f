// SPDX-License-Identifier: MIT
#include "support/tiny_model.h"

namespace relume::test {
namespace {

Occluders two_quads() {
  Occluders occluders;
  occluders.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0},
                         {0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}};
  occluders.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  occluders.material = {0, 0, 1, 1};
  occluders.node = {0, 0, 1, 1};
  occluders.system = {0, 0, 1, 1};
  occluders.front_uv.assign(12, glm::vec2(0.5f));
  occluders.back_uv.assign(12, glm::vec2(0.25f));
  Opacity& opacity = occluders.opacity;
  opacity.maps = {{OpacityRule::mask, 0.5f, 0.75f, 2, 2, WrapMode::repeat, WrapMode::clamp_to_edge, 1}, {}};
  opacity.texels = {9, 255, 0, 0, 255};
  opacity.triangles = {{1, 0, {{{0, 0, 1}, {1, 0, 1}, {1, 1, 0.5}}}},
                       {3, 1, {{{0, 0, 0.25}, {0, 0, 0.25}, {0, 0, 0.25}}}}};
  occluders.texture = {{2, {glm::vec2{0, 0}, glm::vec2{1, 0}, glm::vec2{1, 1}}}};
  // One leaf of all triangles, in a box of 131 steps of 1/128 m, one of which lies around the scene.
  BvhNode root;
  root.origin = glm::vec3(-0x1p-7f);
  root.exponents = {120, 120, 120, 0};
  for (auto& axis : root.upper) axis[0] = 130;
  root.children[0] = bvh_leaf_child({0, 4});
  occluders.bvh = {{root}, {0, 1, 2, 3}};
  return occluders;
}

/// A quad of triangles 2 `index` and 2 `index` + 1: one cluster, element and lumel.
System quad_system(const char* name, std::uint32_t index, float height, float up) {
  System system;
  system.name = name;
  system.lightmap_width = 2;
  system.lightmap_height = 1;
  Cluster cluster;
  cluster.centroid = {0.5f, height, 0.5f};
  cluster.area = 1.0f;
  cluster.normal = {0.0f, up, 0.0f};
  cluster.material = index;
  cluster.albedo = {0.5f, 0.25f, 0.75f};
  cluster.exitance = {1.0f, 0.0f, 2.0f};
  cluster.node = index;
  cluster.element_count = 1;
  system.clusters = {cluster};
  system.elements = {{cluster.centroid, 1.0f, cluster.normal, 0, 0, 2}};
  const std::array<glm::vec2, 3> whole{glm::vec2{0, 0}, glm::vec2{1, 0}, glm::vec2{0, 1}};
  system.pieces = {{2 * index, whole}, {2 * index + 1, whole}};
  system.lumels = {{1, 0, 0, kLumelSplit}};
  system.rays = {{64u << index, 0.25f, {0.5f, 0.125f}}};
  system.cut_errors = {0.75f};
  system.charts = {{index, Side::front, kNone, {2.0f, 1.0f}, {0.0f, 0.0f}}};
  return system;
}

BlockMatrix matrix_of(std::uint32_t columns, ValueCodec codec, const std::vector<std::vector<double>>& rows) {
  BlockMatrixBuilder builder(columns, codec);
  for (const std::vector<double>& row : rows) {
    std::vector<std::uint16_t> all;
    for (std::uint16_t column = 0; column < columns; ++column) all.push_back(column);
    builder.append_row(all, row);
  }
  return std::move(builder).finish();
}

std::vector<Light> three_lights() {
  Light point;
  point.name = "bulb";
  point.intensity = {10.0, 20.0, 30.0};
  point.position = {0.5, 0.5, 0.5};
  point.range = 7.0;
  Light spot = point;
  spot.type = LightType::spot;
  spot.inner_cone_angle = 0.25;
  spot.outer_cone_angle = 0.5;
  Light sun;
  sun.type = LightType::directional;
  sun.intensity = {50000.0, 40000.0, 30000.0};
  sun.direction = {0.0, -1.0, 0.0};
  return {point, spot, sun};
}

}  // namespace

Model tiny_model() {
  Model model;
  model.origin = {100.0, 0.0, -100.0};
  model.geometry_hash = 0x0123456789abcdefull;
  model.sky_resolution = 2;
  model.sky_cells = {8};
  model.materials = {{"paint", false, false}, {"lamp", true, true}};
  model.nodes = {{"room/floor", 11}, {"room/lid", 12}};
  model.sensor_names = {"desk"};
  model.occluders = two_quads();
  model.lights = three_lights();
  model.sky_radiance = Rgb(1000.0, 900.0, 800.0);
  model.lit_by_rig = true;
  model.camera = Camera{};
  model.provenance = {"tiny.glb", "relume 0.1.0", "by hand", "{\"quality\":512}"};

  System floor = quad_system("floor", 0, 0.0f, 1.0f);
  floor.sensors = {{{100.5, 0.25, -99.5}, {0.0f, 1.0f, 0.0f}, 0}};
  floor.lifted_sensors = {{0.5f, 0.25f, 0.5f}};
  floor.imports = {{1, 0}, {kSkySystem, 0}};
  floor.bounce = matrix_of(2, ValueCodec::f32, {{0.2, 0.5}});
  floor.gather = matrix_of(2, ValueCodec::unorm16, {{0.2, 0.5}, {0.25, 0.0}});
  System lid = quad_system("lid", 1, 1.0f, -1.0f);
  lid.imports = {{0, 0}};
  lid.bounce = matrix_of(1, ValueCodec::sqrt8, {{0.2}});
  lid.gather = matrix_of(1, ValueCodec::f32, {{0.2}});
  model.systems = {floor, lid};
  return model;
}

}  // namespace relume::test
