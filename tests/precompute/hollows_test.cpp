// SPDX-License-Identifier: MIT
//
// The insides of solids are left out, where nobody looks and nothing shines.
#include <gtest/gtest.h>

#include <cmath>

#include "core/reference_solver.h"
#include "precompute/precompute.h"
#include "support/scene_builder.h"

namespace relume::test {
namespace {

using P = glm::dvec3;
using Facing = SceneBuilder::Facing;

/// A room of 4 x 3 x 4 m with a lamp, and a way to put things of a double-sided material into it.
struct LitRoom {
  SceneBuilder builder;
  std::uint32_t sheet = 0;

  explicit LitRoom(bool lamp = true) {
    builder.add_box("room", builder.material("wall", Rgb(0.5), Rgb(0.0), true), P(0), P(4, 3, 4),
                    Facing::inward);
    sheet = builder.material("sheet", Rgb(0.5), Rgb(0.0), true);
    if (lamp) {
      builder.add_quad("lamp", builder.material("lamp", Rgb(0.0), Rgb(100.0)),
                       {P(1.5, 2.9, 1.5), P(2.5, 2.9, 1.5), P(2.5, 2.9, 2.5), P(1.5, 2.9, 2.5)});
    }
  }
};

constexpr P kLower{1.5, 1.0, 1.5}, kUpper{2.5, 2.0, 2.5};

PrecomputeOptions coarse() {
  PrecomputeOptions options;
  options.texel_size = 0.25;
  options.cluster_size = 0.5;
  options.quality = 64;
  return options;
}

double hollow_area(const Scene& scene, const PrecomputeOptions& options = coarse()) {
  PrecomputeReport report;
  const auto model = precompute(scene, options, report);
  EXPECT_TRUE(model) << model.error().message;
  return report.hollow_area;
}

/// A closed cube that hangs in the room.
LitRoom room_with_cube(bool lamp = true) {
  LitRoom room(lamp);
  room.builder.add_box("cube", room.sheet, kLower, kUpper, Facing::outward);
  return room;
}

TEST(Hollows, TheInsideOfACubeIsLeftOut) {
  LitRoom room = room_with_cube();
  EXPECT_NEAR(hollow_area(room.builder.scene()), 6.0, 1e-4);
  PrecomputeOptions all = coarse();
  all.keep_hollows = true;
  EXPECT_EQ(hollow_area(room.builder.scene(), all), 0.0);
}

TEST(Hollows, WhatIsLeftIsLitAsBefore) {
  LitRoom room = room_with_cube();
  const auto irradiance = [&](bool keep_hollows) {
    PrecomputeOptions options = coarse();
    options.quality = 1024;
    options.keep_hollows = keep_hollows;
    options.sensors = {{"floor", P(0.5, 0.0, 0.5), P(0, 1, 0)}, {"cube", P(2.0, 2.0, 2.0), P(0, 1, 0)}};
    PrecomputeReport report;
    const auto model = precompute(room.builder.scene(), options, report);
    EXPECT_TRUE(model) << model.error().message;
    const Lighting lighting = stored_lighting(*model);
    const ReferenceMatrices matrices = reference_matrices(*model);
    const auto solution = solve_reference(matrices.bounce, lighting, {});
    EXPECT_TRUE(solution) << solution.error().message;
    const std::vector<Rgb> all = gather(matrices.gather, lighting, solution->radiosity);
    return std::vector<Rgb>(all.end() - 2, all.end());
  };
  const auto with = irradiance(true), without = irradiance(false);
  for (std::size_t i = 0; i < with.size(); ++i)
    EXPECT_NEAR(without[i].g, with[i].g, 0.01 * with[i].g) << "sensor " << i;
}

TEST(Hollows, ALightACameraASensorOrAnEmitterInsideKeepsThem) {
  const P inside(1.9, 1.6, 2.1);
  LitRoom lit = room_with_cube();
  Light lamp;
  lamp.position = inside;
  lit.builder.scene().lights.push_back(lamp);
  EXPECT_EQ(hollow_area(lit.builder.scene()), 0.0);

  LitRoom seen = room_with_cube();
  Camera camera;
  camera.position = inside;
  seen.builder.scene().cameras.push_back(camera);
  EXPECT_EQ(hollow_area(seen.builder.scene()), 0.0);

  PrecomputeOptions options = coarse();
  options.sensors = {{"inside", inside, P(0, 1, 0)}};
  EXPECT_EQ(hollow_area(room_with_cube().builder.scene(), options), 0.0);
  // One on its outside does not look into it.
  options.sensors = {{"outside", P(2.0, 2.0, 2.0), P(0, 1, 0)}, {"under", P(2.0, 1.0, 2.0), P(0, -1, 0)}};
  EXPECT_NEAR(hollow_area(room_with_cube().builder.scene(), options), 6.0, 1e-4);

  LitRoom glowing;
  const auto neon = glowing.builder.material("neon", Rgb(0.5), Rgb(10.0), true);
  glowing.builder.add_box("cube", neon, kLower, kUpper, Facing::outward);
  EXPECT_EQ(hollow_area(glowing.builder.scene()), 0.0);

  LitRoom may_glow = room_with_cube();
  may_glow.builder.scene().nodes.back().extras.emitter = true;
  EXPECT_EQ(hollow_area(may_glow.builder.scene()), 0.0);
}

TEST(Hollows, WhatIsOpenIsNone) {
  LitRoom room;
  const P a = kLower, b = kUpper;
  // A box without a lid: 5 m2 of backs that the lamp shines into.
  room.builder.add_quads("cup", room.sheet,
                         {{P(a.x, a.y, a.z), P(b.x, a.y, a.z), P(b.x, a.y, b.z), P(a.x, a.y, b.z)},
                          {P(a.x, a.y, a.z), P(a.x, a.y, b.z), P(a.x, b.y, b.z), P(a.x, b.y, a.z)},
                          {P(b.x, a.y, b.z), P(b.x, a.y, a.z), P(b.x, b.y, a.z), P(b.x, b.y, b.z)},
                          {P(b.x, a.y, a.z), P(a.x, a.y, a.z), P(a.x, b.y, a.z), P(b.x, b.y, a.z)},
                          {P(a.x, a.y, b.z), P(b.x, a.y, b.z), P(b.x, b.y, b.z), P(a.x, b.y, b.z)}});
  room.builder.add_quad("leaf", room.sheet,
                        {P(0.5, 0.4, 0.5), P(1.0, 0.5, 0.5), P(1.0, 0.5, 1.2), P(0.5, 0.4, 1.2)});
  EXPECT_EQ(hollow_area(room.builder.scene()), 0.0);
}

// Its walls look inwards, although nothing shines: somebody may bring a lamp.
TEST(Hollows, AnUnlitRoomIsNone) {
  LitRoom unlit(false);
  EXPECT_EQ(hollow_area(unlit.builder.scene()), 0.0);
  EXPECT_NEAR(hollow_area(room_with_cube(false).builder.scene()), 6.0, 1e-4);
}

// A house of one body: between its outer and its inner walls is a hollow, its room is none.
TEST(Hollows, TheInsideOfWallsIsLeftOut) {
  SceneBuilder b;
  const auto sheet = b.material("sheet", Rgb(0.5), Rgb(0.0), true);
  b.add_box("inner walls", sheet, P(0), P(4, 3, 4), Facing::inward);
  b.add_box("outer walls", sheet, P(-0.3), P(4.3, 3.3, 4.3), Facing::outward);
  const double inner = 2 * (12 + 12 + 16), outer = 2 * (2 * 4.6 * 3.6 + 4.6 * 4.6);
  EXPECT_NEAR(hollow_area(b.scene()), inner + outer, 1e-3);
}

// A beam through a solid shows its front inside of it.
TEST(Hollows, WhatSticksIntoASolidLeavesItOne) {
  LitRoom room = room_with_cube();
  room.builder.add_box("beam", room.sheet, P(1.0, 1.45, 1.95), P(3.0, 1.55, 2.05), Facing::outward);
  const double cube = 6.0, beam = 2 * (2 * 2.0 * 0.1 + 0.1 * 0.1);
  EXPECT_NEAR(hollow_area(room.builder.scene()), cube + beam, 1e-3);
}

}  // namespace
}  // namespace relume::test
