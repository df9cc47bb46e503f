// SPDX-License-Identifier: MIT
#include "verification/rooms.h"

#include <cmath>
#include <string>

#include "support/scene_builder.h"

namespace relume::test {
namespace {

using P = glm::dvec3;

std::uint32_t uniform(SceneBuilder& builder, const UniformSurface& surface,
                      const std::string& name = "wall") {
  return builder.material(name, Rgb(surface.albedo), Rgb(surface.radiance));
}

/// What may change between two_rooms() and two_rooms_recoloured().
struct Palette {
  Rgb left, right, floor, ceiling, side, divider, crate, bench, left_lamp, right_lamp;
};

constexpr double kDoorLow = 1.0, kDoorHigh = 1.9, kDoorTop = 2.0;

/// Wall in a plane x = `x` with the door cut out, in three quads; looks along +x or -x.
void add_wall_with_door(SceneBuilder& builder, const std::string& node, std::uint32_t material, double x,
                        bool looks_positive) {
  struct Part {
    double y0, y1, z0, z1;
  };
  const Part parts[]{
      {0.0, 2.6, 0.0, kDoorLow}, {kDoorTop, 2.6, kDoorLow, kDoorHigh}, {0.0, 2.6, kDoorHigh, 3.2}};
  std::vector<std::array<P, 4>> quads;
  for (const Part& p : parts) {
    std::array<P, 4> corners{P(x, p.y0, p.z1), P(x, p.y0, p.z0), P(x, p.y1, p.z0), P(x, p.y1, p.z1)};
    if (!looks_positive) std::swap(corners[1], corners[3]);
    quads.push_back(corners);
  }
  builder.add_quads(node, material, quads);
}

/// Lintel and jambs of the door between x = 4 and 4.1; the floor runs through.
void add_door_frame(SceneBuilder& builder, std::uint32_t material) {
  builder.add_quad("frame/top", material,
                   {P(4.0, kDoorTop, kDoorLow), P(4.1, kDoorTop, kDoorLow), P(4.1, kDoorTop, kDoorHigh),
                    P(4.0, kDoorTop, kDoorHigh)});
  builder.add_quad(
      "frame/near", material,
      {P(4.0, 0.0, kDoorLow), P(4.1, 0.0, kDoorLow), P(4.1, kDoorTop, kDoorLow), P(4.0, kDoorTop, kDoorLow)});
  builder.add_quad("frame/far", material,
                   {P(4.1, 0.0, kDoorHigh), P(4.0, 0.0, kDoorHigh), P(4.0, kDoorTop, kDoorHigh),
                    P(4.1, kDoorTop, kDoorHigh)});
}

void add_lamp(SceneBuilder& builder, const std::string& node, std::uint32_t material, const P& corner) {
  builder.add_quad(node, material,
                   {corner, corner + P(0.6, 0, 0), corner + P(0.6, 0, 0.3), corner + P(0, 0, 0.3)});
}

Scene two_rooms_of(const Palette& c) {
  SceneBuilder b;
  const auto left = b.material("left", c.left), right = b.material("right", c.right);
  const auto floor = b.material("floor", c.floor), ceiling = b.material("ceiling", c.ceiling);
  const auto side = b.material("side", c.side), divider = b.material("divider", c.divider);
  const auto crate = b.material("crate", c.crate), bench = b.material("bench", c.bench);
  const auto left_lamp = b.material("left lamp", Rgb(0.4), c.left_lamp);
  const auto right_lamp = b.material("right lamp", Rgb(0.4), c.right_lamp);
  b.add_quad("floor", floor, {P(0, 0, 0), P(0, 0, 3.2), P(7.6, 0, 3.2), P(7.6, 0, 0)});
  b.add_quad("left/ceiling", ceiling, {P(0, 2.6, 0), P(4, 2.6, 0), P(4, 2.6, 3.2), P(0, 2.6, 3.2)});
  b.add_quad("right/ceiling", ceiling, {P(4.1, 2.6, 0), P(7.6, 2.6, 0), P(7.6, 2.6, 3.2), P(4.1, 2.6, 3.2)});
  b.add_quad("left/end", left, {P(0, 0, 3.2), P(0, 0, 0), P(0, 2.6, 0), P(0, 2.6, 3.2)});
  b.add_quad("right/end", right, {P(7.6, 0, 0), P(7.6, 0, 3.2), P(7.6, 2.6, 3.2), P(7.6, 2.6, 0)});
  b.add_quad("side/near", side, {P(0, 0, 0), P(7.6, 0, 0), P(7.6, 2.6, 0), P(0, 2.6, 0)});
  b.add_quad("side/far", side, {P(7.6, 0, 3.2), P(0, 0, 3.2), P(0, 2.6, 3.2), P(7.6, 2.6, 3.2)});
  add_wall_with_door(b, "left/divider", divider, 4.0, false);
  add_wall_with_door(b, "right/divider", divider, 4.1, true);
  add_door_frame(b, divider);
  b.add_standing_box("crate", crate, P(1.2, 0, 0.4), P(1.9, 0.8, 1.1));
  b.add_standing_box("bench", bench, P(5.6, 0, 2.1), P(6.9, 0.5, 2.6));
  add_lamp(b, "left lamp", left_lamp, P(1.7, 2.4, 1.45));
  add_lamp(b, "right lamp", right_lamp, P(5.5, 2.4, 1.45));
  return b.scene();
}

}  // namespace

Scene unit_cube(const UniformSurface& surface) {
  SceneBuilder b;
  b.add_room("cube", uniform(b, surface), P(0.0), P(1.0));
  return b.scene();
}

Scene box_room(const UniformSurface& surface) {
  SceneBuilder b;
  b.add_room("room", uniform(b, surface), P(0.0), P(5.0, 2.5, 4.0));
  return b.scene();
}

Scene l_room(const UniformSurface& surface) {
  SceneBuilder b;
  const auto wall = uniform(b, surface);
  const double h = 2.5;
  b.add_quad("floor/long", wall, {P(0, 0, 0), P(0, 0, 2), P(5, 0, 2), P(5, 0, 0)});
  b.add_quad("floor/short", wall, {P(0, 0, 2), P(0, 0, 4), P(2.5, 0, 4), P(2.5, 0, 2)});
  b.add_quad("ceiling/long", wall, {P(0, h, 0), P(5, h, 0), P(5, h, 2), P(0, h, 2)});
  b.add_quad("ceiling/short", wall, {P(0, h, 2), P(2.5, h, 2), P(2.5, h, 4), P(0, h, 4)});
  const std::array<glm::dvec2, 6> outline{glm::dvec2{0, 0}, {5, 0}, {5, 2}, {2.5, 2}, {2.5, 4}, {0, 4}};
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 a = outline[i], c = outline[(i + 1) % outline.size()];
    b.add_quad("wall/" + std::to_string(i), wall,
               {P(a.x, 0, a.y), P(c.x, 0, c.y), P(c.x, h, c.y), P(a.x, h, a.y)});
  }
  return b.scene();
}

Scene sphere_room(std::uint32_t rings, double cap_height, const UniformSurface& wall,
                  const UniformSurface& cap) {
  SceneBuilder b;
  const auto wall_material = uniform(b, wall), cap_material = uniform(b, cap, "cap");
  const auto at = [&](std::uint32_t ring, std::uint32_t segment) {
    const double theta = kPi * ring / rings, phi = kPi * (segment % (2 * rings)) / rings;
    const double radius = ring == 0 || ring == rings ? 0.0 : std::sin(theta);
    return P(radius * std::cos(phi), std::cos(theta), radius * std::sin(phi));
  };
  std::vector<P> positions[2];
  std::vector<std::array<std::uint32_t, 3>> triangles[2];
  const auto add = [&](const P& p, const P& q, const P& r) {
    const std::size_t part = (p.y + q.y + r.y) / 3.0 > cap_height ? 1 : 0;
    const auto first = std::uint32_t(positions[part].size());
    positions[part].insert(positions[part].end(), {p, q, r});
    triangles[part].push_back({first, first + 1, first + 2});
  };
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    for (std::uint32_t s = 0; s < 2 * rings; ++s) {
      const P a = at(ring, s), c = at(ring, s + 1), d = at(ring + 1, s + 1), e = at(ring + 1, s);
      if (ring > 0) add(a, d, c);
      if (ring + 1 < rings) add(a, e, d);
    }
  }
  b.add_triangles("wall", wall_material, positions[0], triangles[0]);
  if (!positions[1].empty()) b.add_triangles("cap", cap_material, positions[1], triangles[1]);
  return b.scene();
}

Scene furnished_room(const UniformSurface& surface) {
  SceneBuilder b;
  const auto wall = uniform(b, surface);
  b.add_room("room", wall, P(0.0), P(4.0, 2.5, 3.0));
  b.add_box("table/top", wall, P(1.2, 0.72, 1.0), P(2.4, 0.76, 1.8), SceneBuilder::Facing::outward);
  int leg = 0;
  for (const auto& [x, z] : {std::pair{1.25, 1.05}, {2.3, 1.05}, {1.25, 1.7}, {2.3, 1.7}}) {
    b.add_standing_box("table/leg " + std::to_string(++leg), wall, P(x, 0.0, z), P(x + 0.05, 0.72, z + 0.05));
  }
  b.add_standing_box("cabinet", wall, P(3.0, 0.0, 0.3), P(3.6, 1.1, 0.8));
  b.add_box("shelf", wall, P(0.01, 1.4, 0.8), P(0.25, 1.43, 2.2), SceneBuilder::Facing::outward);
  return b.scene();
}

Scene two_rooms() {
  return two_rooms_of({{0.8, 0.35, 0.3},
                       {0.3, 0.45, 0.75},
                       {0.45, 0.38, 0.32},
                       {0.8, 0.8, 0.8},
                       {0.65, 0.65, 0.6},
                       {0.7, 0.7, 0.7},
                       {0.5, 0.4, 0.3},
                       {0.3, 0.6, 0.35},
                       {60, 55, 45},
                       {6, 8, 12}});
}

std::vector<Footprint> two_rooms_footprints() {
  return {{1.2, 1.9, 0.4, 1.1}, {5.6, 6.9, 2.1, 2.6}};
}

Scene two_rooms_recoloured() {
  return two_rooms_of({{0.3, 0.7, 0.4},
                       {0.8, 0.8, 0.4},
                       {0.7, 0.6, 0.5},
                       {0.6, 0.7, 0.8},
                       {0.4, 0.3, 0.6},
                       {0.3, 0.3, 0.5},
                       {0.8, 0.3, 0.3},
                       {0.7, 0.7, 0.3},
                       {0, 0, 0},
                       {20, 30, 50}});
}

Scene sealed_rooms(double thickness) {
  SceneBuilder b;
  const auto wall = b.material("wall", Rgb(0.7)), lamp = b.material("lamp", Rgb(0.3), Rgb(100.0));
  const double near = 2.0, far = 2.0 + thickness, end = far + 3.1;
  b.add_quad("floor", wall, {P(0, 0, 0), P(0, 0, 2), P(end, 0, 2), P(end, 0, 0)});
  b.add_quad("ceiling", wall, {P(0, 2, 0), P(end, 2, 0), P(end, 2, 2), P(0, 2, 2)});
  b.add_quad("side/near", wall, {P(0, 0, 0), P(end, 0, 0), P(end, 2, 0), P(0, 2, 0)});
  b.add_quad("side/far", wall, {P(end, 0, 2), P(0, 0, 2), P(0, 2, 2), P(end, 2, 2)});
  b.add_quad("lit/end", wall, {P(0, 0, 2), P(0, 0, 0), P(0, 2, 0), P(0, 2, 2)});
  b.add_quad("dark/end", wall, {P(end, 0, 0), P(end, 0, 2), P(end, 2, 2), P(end, 2, 0)});
  b.add_quad("lit/divider", wall, {P(near, 0, 0), P(near, 0, 2), P(near, 2, 2), P(near, 2, 0)});
  b.add_quad("dark/divider", wall, {P(far, 0, 2), P(far, 0, 0), P(far, 2, 0), P(far, 2, 2)});
  b.add_quad("lamp", lamp, {P(0.8, 1.9, 0.8), P(1.2, 1.9, 0.8), P(1.2, 1.9, 1.2), P(0.8, 1.9, 1.2)});
  return b.scene();
}

Scene lamp_room(double size, double albedo) {
  SceneBuilder b;
  const auto wall = b.material("wall", Rgb(albedo)), lamp = b.material("lamp", Rgb(albedo), Rgb(100.0));
  b.add_room("room", wall, P(0.0), P(4.0, 2.5, 4.0));
  const double low = 2.0 - size / 2, high = 2.0 + size / 2, y = 2.499;
  b.add_quad("lamp", lamp, {P(low, y, low), P(high, y, low), P(high, y, high), P(low, y, high)});
  return b.scene();
}

}  // namespace relume::test
