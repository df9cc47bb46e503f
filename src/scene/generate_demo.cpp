// SPDX-License-Identifier: MIT
#include <cmath>
#include <glm/geometric.hpp>

#include "scene/generate_scene.h"
#include "scene/shapes.h"

namespace relume {
namespace {

const glm::dvec3 kRoom(5.0, 2.7, 6.0);
const Rgb kOak(0.42, 0.27, 0.15);
const Rgb kWhite(0.80, 0.79, 0.76);
const Rgb kMetal(0.25, 0.25, 0.26);

/// Collects boxes into one mesh.
class Boxes {
 public:
  Boxes& add(const glm::dvec3& low, const glm::dvec3& high, std::uint32_t faces = kAllFaces) {
    append_box(mesh_, low, high, faces);
    return *this;
  }
  GlbPrimitive take() { return std::move(mesh_); }

 private:
  GlbPrimitive mesh_;
};

/// Four legs of a rectangle, standing on the floor at `y`.
void add_legs(Boxes& boxes, const glm::dvec3& low, const glm::dvec3& high, double y, double width) {
  for (const double x : {low.x, high.x - width}) {
    for (const double z : {low.z, high.z - width}) {
      boxes.add({x, y, z}, {x + width, low.y, z + width}, kAllFaces & ~(kBottom | kTop));
    }
  }
}

GlbPrimitive inward(const glm::dvec3& low, const glm::dvec3& high, std::uint32_t faces) {
  GlbPrimitive mesh;
  append_box(mesh, low, high, faces, Facing::inward);
  return mesh;
}

/// The window: a bright pane behind a reveal in the left wall, with a cross of bars in front.
void add_window_wall(GlbScene& scene) {
  const glm::dvec3 low(-0.22, 0.9, 1.9);
  const glm::dvec3 high(0.0, 2.3, 3.9);
  GlbPrimitive wall;
  append_quad_with_hole(wall, {0.0, 0.0, kRoom.z}, {0.0, 0.0, -kRoom.z}, {0.0, kRoom.y, 0.0},
                        {1.0 - high.z / kRoom.z, low.y / kRoom.y}, {1.0 - low.z / kRoom.z, high.y / kRoom.y});
  add_surface(scene, "wall_window", kWhite, std::move(wall));
  add_surface(scene, "window_reveal", Rgb(0.82), inward(low, high, kBottom | kTop | kBack | kFront));
  add_surface(scene, "window", Rgb(0.3), inward(low, high, kLeft), {1500.0, 1750.0, 2100.0});
  const double middle_y = (low.y + high.y) / 2;
  const double middle_z = (low.z + high.z) / 2;
  Boxes bars;
  bars.add({-0.14, low.y, middle_z - 0.025}, {-0.10, high.y, middle_z + 0.025},
           kAllFaces & ~(kBottom | kTop));
  bars.add({-0.135, middle_y - 0.02, low.z}, {-0.105, middle_y + 0.02, middle_z - 0.025},
           kAllFaces & ~(kBack | kFront));
  bars.add({-0.135, middle_y - 0.02, middle_z + 0.025}, {-0.105, middle_y + 0.02, high.z},
           kAllFaces & ~(kBack | kFront));
  add_surface(scene, "window_bars", Rgb(0.75), bars.take());
}

void add_shell(GlbScene& scene) {
  const glm::dvec3 low(0.0);
  add_surface(scene, "floor", {0.38, 0.27, 0.18}, inward(low, kRoom, kBottom));
  add_surface(scene, "ceiling", Rgb(0.85), inward(low, kRoom, kTop));
  add_surface(scene, "wall_back", {0.68, 0.38, 0.26}, inward(low, kRoom, kBack));
  add_surface(scene, "wall_right", {0.30, 0.52, 0.50}, inward(low, kRoom, kRight));
  add_surface(scene, "wall_front", kWhite, inward(low, kRoom, kFront));
  add_window_wall(scene);
  Boxes door;
  door.add({kRoom.x - 0.04, 0.0, 1.5}, {kRoom.x, 2.05, 2.4}, kAllFaces & ~(kBottom | kRight));
  add_surface(scene, "door", {0.72, 0.70, 0.64}, door.take());
}

void add_lamp_panel(GlbScene& scene) {
  const glm::dvec3 low(2.2, 2.62, 2.7);
  const glm::dvec3 high(2.8, 2.66, 3.3);
  Boxes housing;
  housing.add(low, high, kAllFaces & ~kBottom);
  add_surface(scene, "lamp_housing", Rgb(0.6), housing.take());
  Boxes panel;
  panel.add(low, high, kBottom);
  add_surface(scene, "lamp_panel", Rgb(0.5), panel.take(), {1500.0, 1300.0, 1000.0});
}

void add_floor_lamp(GlbScene& scene) {
  const glm::dvec3 foot(0.55, 0.0, 0.55);
  GlbPrimitive stand;
  append_revolved(stand, foot, 4, 24, [](double t) {
    const double radius[] = {0.16, 0.16, 0.015, 0.015, 0.0};
    const double height[] = {0.0, 0.025, 0.03, 1.46, 1.46};
    const int i = static_cast<int>(std::lround(4.0 * t));
    return glm::dvec2(radius[i], height[i]);
  });
  add_surface(scene, "floor_lamp_stand", kMetal, std::move(stand));
  GlbPrimitive shade;
  append_revolved(shade, foot, 4, 32, [](double t) { return glm::dvec2(0.24 - 0.09 * t, 1.42 + 0.32 * t); });
  add_surface(scene, "floor_lamp_shade", {0.78, 0.66, 0.48}, std::move(shade), Rgb(0.0), true);
  Light light;
  light.name = "floor_lamp";
  light.position = foot + glm::dvec3(0.0, 1.58, 0.0);
  light.intensity = {95.0, 68.0, 40.0};
  add_light(scene, light);
}

void add_sofa(GlbScene& scene) {
  Boxes sofa;
  sofa.add({1.25, 0.08, 0.10}, {3.25, 0.42, 0.95});
  sofa.add({1.25, 0.422, 0.10}, {3.25, 0.84, 0.32});
  sofa.add({1.03, 0.08, 0.10}, {1.248, 0.60, 0.95});
  sofa.add({3.252, 0.08, 0.10}, {3.47, 0.60, 0.95});
  add_surface(scene, "sofa", {0.14, 0.21, 0.36}, sofa.take());
  Boxes cushion;
  cushion.add({1.40, 0.425, 0.34}, {1.80, 0.80, 0.46});
  add_surface(scene, "cushion", {0.76, 0.55, 0.14}, cushion.take());
  Boxes picture;
  picture.add({1.7, 1.35, 0.0}, {2.8, 2.05, 0.03}, kAllFaces & ~kBack);
  add_surface(scene, "picture_frame", {0.10, 0.09, 0.08}, picture.take());
  Boxes canvas;
  canvas.add({1.76, 1.41, 0.031}, {2.30, 1.99, 0.033}, kFront);
  add_surface(scene, "picture_left", {0.75, 0.62, 0.22}, canvas.take());
  canvas.add({2.32, 1.41, 0.031}, {2.74, 1.99, 0.033}, kFront);
  add_surface(scene, "picture_right", {0.18, 0.38, 0.55}, canvas.take());
}

/// A vase: up the outside, over the lip, down the inside.
GlbPrimitive vase(const glm::dvec3& foot) {
  const auto outside = [](double h) {
    return glm::dvec2(0.055 + 0.060 * std::sin(kPi * std::pow(h, 0.75)) - 0.012 * h, 0.32 * h);
  };
  GlbPrimitive mesh;
  append_revolved(mesh, foot, 60, 64, [&](double t) {
    if (t <= 0.6) return outside(t / 0.6);
    const double down = (t - 0.6) / 0.4;
    const glm::dvec2 at = outside(1.0 - 0.9 * down);
    return glm::dvec2(down >= 1.0 ? 0.0 : at.x - 0.008, at.y);
  });
  return mesh;
}

void add_coffee_table(GlbScene& scene) {
  Boxes rug;
  rug.add({1.0, 0.0, 1.45}, {3.7, 0.012, 3.35}, kStandingFaces);
  add_surface(scene, "rug", {0.58, 0.22, 0.20}, rug.take());
  Boxes table;
  const glm::dvec3 low(1.8, 0.38, 2.0);
  const glm::dvec3 high(2.9, 0.42, 2.7);
  table.add(low, high);
  add_legs(table, low, high, 0.012, 0.05);
  add_surface(scene, "coffee_table", kOak, table.take());
  add_surface(scene, "vase", {0.22, 0.50, 0.60}, vase({2.12, high.y, 2.32}));
  GlbPrimitive ball;
  append_sphere(ball, {2.6, high.y + 0.11, 2.4}, 0.11, 0.0, kPi, 32, 48);
  add_surface(scene, "ball", {0.80, 0.78, 0.74}, std::move(ball));
}

void add_chair(GlbScene& scene, const std::string& name, const glm::dvec3& at, double back_sign) {
  Boxes chair;
  const glm::dvec3 low = at + glm::dvec3(-0.21, 0.44, -0.21);
  const glm::dvec3 high = at + glm::dvec3(0.21, 0.475, 0.21);
  chair.add(low, high);
  add_legs(chair, low, high, 0.0, 0.035);
  const double z = at.z + back_sign * 0.19;
  chair.add({low.x, high.y + 0.002, z - 0.015}, {high.x, 0.92, z + 0.015});
  add_surface(scene, name, {0.62, 0.20, 0.12}, chair.take());
}

void add_dining_table(GlbScene& scene) {
  Boxes table;
  const glm::dvec3 low(0.45, 0.71, 3.75);
  const glm::dvec3 high(1.85, 0.75, 4.6);
  table.add(low, high);
  add_legs(table, low, high, 0.0, 0.06);
  add_surface(scene, "table", kOak, table.take());
  add_chair(scene, "chair_near", {1.15, 0.0, 4.75}, 1.0);
  add_chair(scene, "chair_far", {1.15, 0.0, 3.55}, -1.0);
  GlbPrimitive bowl;
  append_revolved(bowl, {1.05, high.y, 4.15}, 32, 48, [](double t) {
    const double h = t <= 0.5 ? 2.0 * t : 2.0 * (1.0 - t);
    const double radius = 0.07 + 0.10 * std::sqrt(h) - (t > 0.5 ? 0.008 : 0.0);
    return glm::dvec2(t >= 1.0 ? 0.0 : radius, 0.004 * (t > 0.5) + 0.10 * h);
  });
  add_surface(scene, "bowl", {0.70, 0.68, 0.30}, std::move(bowl));
}

/// Books of some widths, heights and colours from left to right of a board.
void add_books(GlbScene& scene, const std::string& name, double board_y, double from_x, std::size_t count) {
  const Rgb colors[] = {{0.55, 0.14, 0.12}, {0.16, 0.30, 0.18}, {0.70, 0.62, 0.42}, {0.14, 0.18, 0.40}};
  Boxes books[4];
  double x = from_x;
  for (std::size_t i = 0; i < count; ++i) {
    const double width = 0.028 + 0.009 * static_cast<double>((i * 5) % 4);
    const double height = 0.20 + 0.025 * static_cast<double>((i * 7) % 4);
    books[(i * 3 + i / 4) % 4].add({x, board_y, 0.06}, {x + width, board_y + height, 0.26}, kStandingFaces);
    x += width + 0.003;
  }
  for (std::size_t c = 0; c < 4; ++c) {
    if (GlbPrimitive mesh = books[c].take(); !mesh.triangles.empty()) {
      add_surface(scene, name + "_" + std::to_string(c + 1), colors[c], std::move(mesh));
    }
  }
}

void add_shelf(GlbScene& scene) {
  const double from = 3.68;
  const double to = 4.92;
  const double first_board = 0.08;
  const double step = 0.445;
  Boxes shelf;
  shelf.add({from, 0.0, 0.02}, {from + 0.03, 1.9, 0.32}, kStandingFaces);
  shelf.add({to - 0.03, 0.0, 0.02}, {to, 1.9, 0.32}, kStandingFaces);
  for (int i = 0; i < 5; ++i) {
    const double y = first_board + step * i;
    shelf.add({from + 0.032, y, 0.02}, {to - 0.032, y + 0.025, 0.32});
  }
  add_surface(scene, "shelf", {0.74, 0.70, 0.62}, shelf.take());
  const double on_board = first_board + 0.026;
  add_books(scene, "books_low", on_board + step, 3.75, 17);
  add_books(scene, "books_middle", on_board + 2 * step, 4.05, 15);
  add_books(scene, "books_high", on_board + 3 * step, 3.75, 11);
  GlbPrimitive globe;
  append_sphere(globe, {4.62, on_board + 3 * step + 0.12, 0.17}, 0.12, 0.0, kPi, 24, 36);
  add_surface(scene, "globe", {0.30, 0.48, 0.62}, std::move(globe));
}

}  // namespace

GlbScene demo_scene() {
  GlbScene scene;
  add_shell(scene);
  add_lamp_panel(scene);
  add_floor_lamp(scene);
  add_sofa(scene);
  add_coffee_table(scene);
  add_dining_table(scene);
  add_shelf(scene);
  const glm::dvec3 eye(4.35, 1.55, 5.75);
  const glm::dvec3 target(2.0, 0.95, 1.6);
  add_camera(scene, "camera", {eye, glm::normalize(target - eye), {0.0, 1.0, 0.0}, 55.0 * kPi / 180.0});
  return scene;
}

}  // namespace relume
