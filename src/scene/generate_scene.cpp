// SPDX-License-Identifier: MIT
#include "scene/generate_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "scene/shapes.h"

namespace relume {
namespace {

constexpr double kDegree = kPi / 180.0;

GlbPrimitive quad(const glm::dvec3& a, const glm::dvec3& u, const glm::dvec3& v) {
  GlbPrimitive mesh;
  append_quad(mesh, a, u, v);
  return mesh;
}

GlbPrimitive box(const glm::dvec3& low, const glm::dvec3& high, std::uint32_t faces, Facing facing) {
  GlbPrimitive mesh;
  append_box(mesh, low, high, faces, facing);
  return mesh;
}

GlbPrimitive sphere(double from_angle, double to_angle, std::uint32_t rings) {
  GlbPrimitive mesh;
  append_sphere(mesh, glm::dvec3(0.0), 1.0, from_angle, to_angle, rings, 48, Facing::inward);
  return mesh;
}

GlbScene furnace_box() {
  GlbScene scene;
  add_surface(scene, "wall", Rgb(0.5), box(glm::dvec3(0.0), glm::dvec3(1.0), kAllFaces, Facing::inward),
              Rgb(1.0));
  return scene;
}

GlbScene furnace_sphere() {
  GlbScene scene;
  add_surface(scene, "wall", Rgb(0.5), sphere(0.0, kPi, 24), Rgb(1.0));
  return scene;
}

GlbScene cap_sphere() {
  GlbScene scene;
  add_surface(scene, "cap", Rgb(0.5), sphere(0.0, 40.0 * kDegree, 8), Rgb(10.0));
  add_surface(scene, "wall", Rgb(0.5), sphere(40.0 * kDegree, kPi, 24));
  return scene;
}

GlbScene lamp_room() {
  const glm::dvec3 size(4.0, 2.5, 4.0);
  const double half = 0.15;
  GlbScene scene;
  add_surface(scene, "room", Rgb(0.5), box(glm::dvec3(0.0), size, kStandingFaces & ~kTop, Facing::inward));
  add_surface(scene, "floor", Rgb(0.5), box(glm::dvec3(0.0), size, kBottom, Facing::inward));
  GlbPrimitive ceiling;
  append_quad_with_hole(ceiling, {0.0, size.y, 0.0}, {size.x, 0.0, 0.0}, {0.0, 0.0, size.z},
                        {0.5 - half / size.x, 0.5 - half / size.z},
                        {0.5 + half / size.x, 0.5 + half / size.z});
  add_surface(scene, "ceiling", Rgb(0.5), std::move(ceiling));
  add_surface(
      scene, "lamp", Rgb(0.5),
      quad({size.x / 2 - half, size.y, size.z / 2 - half}, {2 * half, 0.0, 0.0}, {0.0, 0.0, 2 * half}),
      Rgb(1000.0));
  return scene;
}

GlbScene light_plane() {
  GlbScene scene;
  add_surface(scene, "plane", Rgb(0.5), quad({-5.0, 0.0, 5.0}, {10.0, 0.0, 0.0}, {0.0, 0.0, -10.0}));
  return scene;
}

/// Two rooms side by side along x. Floor, ceiling and the long walls run through both, over, under and behind
/// the wall between them.
struct TwoRooms {
  glm::dvec3 size{6.7, 2.5, 3.2};
  double wall_from = 3.6;  ///< x
  double wall_to = 3.7;
  double door_from = 1.1;  ///< z
  double door_to = 2.0;
  double door_height = 2.0;
};

void add_shell(GlbScene& scene, const TwoRooms& rooms) {
  const glm::dvec3 low(0.0);
  add_surface(scene, "floor", {0.45, 0.40, 0.35}, box(low, rooms.size, kBottom, Facing::inward));
  add_surface(scene, "wall_back", {0.70, 0.68, 0.64}, box(low, rooms.size, kBack, Facing::inward));
  add_surface(scene, "wall_front", {0.62, 0.66, 0.70}, box(low, rooms.size, kFront, Facing::inward));
  add_surface(scene, "wall_lit", {0.70, 0.32, 0.30}, box(low, rooms.size, kLeft, Facing::inward));
  add_surface(scene, "wall_dark", {0.30, 0.45, 0.70}, box(low, rooms.size, kRight, Facing::inward));
  GlbPrimitive ceiling;
  const glm::dvec2 lamp_low(1.5, 1.3);
  const glm::dvec2 lamp_high(2.1, 1.9);
  const glm::dvec2 span(rooms.size.x, rooms.size.z);
  append_quad_with_hole(ceiling, {0.0, rooms.size.y, 0.0}, {span.x, 0.0, 0.0}, {0.0, 0.0, span.y},
                        lamp_low / span, lamp_high / span);
  add_surface(scene, "ceiling", Rgb(0.80), std::move(ceiling));
  add_surface(scene, "lamp", Rgb(0.5),
              quad({lamp_low.x, rooms.size.y, lamp_low.y}, {lamp_high.x - lamp_low.x, 0.0, 0.0},
                   {0.0, 0.0, lamp_high.y - lamp_low.y}),
              {500.0, 460.0, 400.0});
}

void add_middle_wall(GlbScene& scene, const TwoRooms& rooms, bool has_door) {
  const glm::dvec3 up(0.0, rooms.size.y, 0.0);
  const glm::dvec3 along(0.0, 0.0, rooms.size.z);
  const glm::dvec3 lit_corner(rooms.wall_from, 0.0, 0.0);
  const glm::dvec3 dark_corner(rooms.wall_to, 0.0, rooms.size.z);
  GlbPrimitive lit;
  GlbPrimitive dark;
  if (has_door) {
    const double top = rooms.door_height / rooms.size.y;
    const double from = rooms.door_from / rooms.size.z;
    const double to = rooms.door_to / rooms.size.z;
    append_quad_with_hole(lit, lit_corner, along, up, {from, 0.0}, {to, top});
    append_quad_with_hole(dark, dark_corner, -along, up, {1.0 - to, 0.0}, {1.0 - from, top});
    add_surface(
        scene, "doorway", Rgb(0.6),
        box({rooms.wall_from, 0.0, rooms.door_from}, {rooms.wall_to, rooms.door_height, rooms.door_to},
            kTop | kBack | kFront, Facing::inward));
  } else {
    append_quad(lit, lit_corner, along, up);
    append_quad(dark, dark_corner, -along, up);
  }
  add_surface(scene, "middle_lit", {0.55, 0.62, 0.45}, std::move(lit));
  add_surface(scene, "middle_dark", {0.72, 0.64, 0.40}, std::move(dark));
}

GlbScene two_rooms(bool has_door) {
  const TwoRooms rooms;
  GlbScene scene;
  add_shell(scene, rooms);
  add_middle_wall(scene, rooms, has_door);
  const auto standing = [](const glm::dvec3& low, const glm::dvec3& high) {
    return box(low, high, kStandingFaces, Facing::outward);
  };
  add_surface(scene, "box_lit_low", {0.60, 0.50, 0.30}, standing({0.5, 0.0, 0.4}, {1.3, 0.6, 1.0}));
  add_surface(scene, "box_lit_high", {0.35, 0.55, 0.60}, standing({2.4, 0.0, 2.4}, {2.9, 1.4, 2.9}));
  add_surface(scene, "box_dark_low", {0.65, 0.40, 0.50}, standing({4.6, 0.0, 0.5}, {5.3, 0.5, 1.2}));
  add_surface(scene, "box_dark_high", {0.50, 0.50, 0.50}, standing({5.6, 0.0, 2.2}, {6.1, 1.6, 2.7}));
  Light light;
  light.name = "point";
  light.position = {0.9, 1.7, 2.3};
  light.intensity = {60.0, 55.0, 45.0};
  add_light(scene, light);
  add_camera(scene, "camera", {{0.4, 1.5, 2.9}, {0.86, -0.18, -0.48}, {0.0, 1.0, 0.0}, 60.0 * kDegree});
  return scene;
}

using Maker = GlbScene (*)();

const std::vector<std::pair<std::string, Maker>>& makers() {
  static const std::vector<std::pair<std::string, Maker>> all = {
      {"demo", &demo_scene},
      {"furnace_box", &furnace_box},
      {"furnace_sphere", &furnace_sphere},
      {"cap_sphere", &cap_sphere},
      {"two_rooms", [] { return two_rooms(true); }},
      {"two_rooms_sealed", [] { return two_rooms(false); }},
      {"lamp_room", &lamp_room},
      {"light_plane", &light_plane},
  };
  return all;
}

}  // namespace

void add_surface(GlbScene& scene, const std::string& name, const Rgb& albedo, GlbPrimitive mesh,
                 const Rgb& radiance, bool double_sided) {
  GlbMaterial material;
  material.name = name;
  material.base_color = albedo;
  material.emission = radiance;
  material.double_sided = double_sided;
  mesh.material = static_cast<std::uint32_t>(scene.materials.size());
  scene.materials.push_back(std::move(material));
  GlbNode node;
  node.name = name;
  node.mesh = static_cast<std::uint32_t>(scene.meshes.size());
  scene.meshes.push_back({name, {std::move(mesh)}});
  scene.nodes.push_back(std::move(node));
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : makers()) names.push_back(name);
  return names;
}

Result<GlbScene> generate_scene(const std::string& name) {
  for (const auto& [known, make] : makers()) {
    if (known == name) return make();
  }
  return fail(ErrorCode::usage, fmt::format("no scene is called \"{}\": expected one of {}", name,
                                            fmt::join(scene_names(), ", ")));
}

}  // namespace relume
