// SPDX-License-Identifier: MIT
//
// Scenes that precomputes fail on, through every method. What is right comes from closed forms: in a closed
// room of uniform exitance M and albedo rho every radiosity is M / (1 - rho), whatever its surfaces are cut
// into.
#include <gtest/gtest.h>

#include <iostream>

#include "core/quantities.h"
#include "precompute/direct_irradiance.h"
#include "stability/lab.h"
#include "support/matrices.h"
#include "support/scene_builder.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

using P = glm::dvec3;
using Facing = SceneBuilder::Facing;

constexpr double kAlbedo = 0.9, kExitance = 2.0;
constexpr double kFurnace = kExitance / (1.0 - kAlbedo);

/// A model with its lighting, and between which values the radiosity of each cluster must lie.
struct SceneCase {
  std::string name;
  Model model;
  Lighting lighting;
  std::vector<double> low, high;
};

Model precomputed(const Scene& scene, double size) {
  PrecomputeOptions options;
  options.cluster_size = size / 3.0, options.texel_size = size / 6.0, options.quality = 64;
  return precompute_or_throw(scene, options);
}

/// All clusters alike, with radiosities from `low` to `high`.
SceneCase uniform_case(const std::string& name, Model model, double low, double high) {
  const std::size_t n = cluster_offsets(model).back();
  Lighting lighting = uniform_lighting(n, Rgb(kAlbedo), Rgb(kExitance));
  lighting.sky_radiosity.assign(model.sky_cells.size(), Rgb(0.0));
  return {name, std::move(model), std::move(lighting), std::vector<double>(n, low),
          std::vector<double>(n, high)};
}

SceneCase furnace(const std::string& name, const Scene& scene, double size) {
  return uniform_case(name, precomputed(scene, size), (1.0 - 1e-3) * kFurnace, (1.0 + 1e-3) * kFurnace);
}

SceneBuilder room(const P& lower, double size) {
  SceneBuilder b;
  b.add_room("room", b.material("wall", Rgb(kAlbedo)), lower, lower + P(size));
  return b;
}

SceneCase size_case(const std::string& name, double size) {
  return furnace(name, room(P(0.0), size).scene(), size);
}

SceneCase far_away() {
  return furnace("1 m, 1e6 m from the origin", room(P(1e6, -1e6, 1e6), 1.0).scene(), 1.0);
}

/// Besides the floor, four strips of 1 m x 1 um between its halves.
SceneCase slivers() {
  SceneBuilder b;
  const auto wall = b.material("wall", Rgb(kAlbedo));
  constexpr int kStrips = 4;
  constexpr double kWidth = 1e-6, kMiddle = 0.4;
  double z = 0.0;
  std::vector<std::array<P, 4>> floor;
  for (int strip = 0; strip <= kStrips + 1; ++strip) {
    const double end = strip == 0 ? kMiddle : strip > kStrips ? 1.0 : z + kWidth;
    floor.push_back({P(0, 0, z), P(0, 0, end), P(1, 0, end), P(1, 0, z)});
    z = end;
  }
  b.add_quads("floor", wall, floor);
  b.add_quad("ceiling", wall, {P(0, 1, 0), P(1, 1, 0), P(1, 1, 1), P(0, 1, 1)});
  b.add_quad("-x", wall, {P(0, 0, 0), P(0, 1, 0), P(0, 1, 1), P(0, 0, 1)});
  b.add_quad("+x", wall, {P(1, 0, 1), P(1, 1, 1), P(1, 1, 0), P(1, 0, 0)});
  b.add_quad("-z", wall, {P(0, 0, 0), P(1, 0, 0), P(1, 1, 0), P(0, 1, 0)});
  b.add_quad("+z", wall, {P(1, 0, 1), P(0, 0, 1), P(0, 1, 1), P(1, 1, 1)});
  return furnace("slivers of 1e6 : 1", b.scene(), 1.0);
}

/// The floor a second time, and a quad that overlaps a part of both.
SceneCase overlapping_faces() {
  SceneBuilder b = room(P(0.0), 1.0);
  b.add_quad("floor again", 0, {P(0, 0, 0), P(0, 0, 1), P(1, 0, 1), P(1, 0, 0)});
  b.add_quad("rug", 0, {P(0.2, 0, 0.3), P(0.2, 0, 0.9), P(0.7, 0, 0.9), P(0.7, 0, 0.3)});
  return furnace("coplanar faces that overlap", b.scene(), 1.0);
}

/// Fronts look at nothing: what is emitted is all there is.
SceneCase inside_out() {
  SceneBuilder b;
  b.add_box("box", b.material("wall", Rgb(kAlbedo)), P(0.0), P(1.0), Facing::outward);
  return uniform_case("a room inside out", precomputed(b.scene(), 1.0), kExitance, kExitance);
}

/// A box whose fronts look into it stands in a room: a furnace of its own, black from outside.
SceneCase inside_out_furniture() {
  SceneBuilder b = room(P(0.0), 1.0);
  b.add_box("box", 0, P(0.3), P(0.6), Facing::inward);
  SceneCase c = uniform_case("furniture inside out", precomputed(b.scene(), 1.0), kExitance, 0.9 * kFurnace);
  std::size_t i = 0;
  for (const System& system : c.model.systems) {
    for (const Cluster& cluster : system.clusters) {
      if (c.model.nodes[cluster.node].path == "box")
        c.low[i] = (1.0 - 1e-3) * kFurnace, c.high[i] = (1.0 + 1e-3) * kFurnace;
      ++i;
    }
  }
  return c;
}

double flux(const Model& model, const std::vector<double>& irradiance) {
  const std::vector<double> areas = cluster_areas(model);
  double sum = 0.0;
  for (std::size_t i = 0; i < areas.size(); ++i) sum += areas[i] * irradiance[i];
  return sum;
}

/// All light is absorbed in the end: sum A (1 - rho) / rho B is the flux that arrives from the lamp, since
/// nothing is emitted.
SceneCase lamp_on_the_floor() {
  SceneCase c = uniform_case("a light on a surface", precomputed(room(P(0.0), 1.0).scene(), 1.0), 0.0, 1e9);
  Light light;
  light.intensity = Rgb(100.0);
  light.position = {0.41, 0.0, 0.37};
  const auto direct = direct_irradiance(c.model, std::vector{light});
  if (!direct) throw std::runtime_error(direct.error().message);
  c.lighting.direct = direct->clusters;
  std::fill(c.lighting.exitance.begin(), c.lighting.exitance.end(), Rgb(0.0));
  return c;
}

std::vector<SceneCase> scene_cases() {
  std::vector<SceneCase> cases;
  cases.push_back(size_case("a scene of 1e-3 m", 1e-3));
  cases.push_back(size_case("a scene of 1e6 m", 1e6));
  cases.push_back(far_away());
  cases.push_back(slivers());
  cases.push_back(overlapping_faces());
  cases.push_back(inside_out());
  cases.push_back(inside_out_furniture());
  cases.push_back(lamp_on_the_floor());
  return cases;
}

Case lab_case(const SceneCase& scene) {
  const std::size_t n = scene.lighting.albedo.size();
  Case c{scene.name,
         reference_matrices(scene.model).bounce,
         scene.lighting,
         cluster_areas(scene.model),
         Rooms{std::vector<std::uint32_t>(n, 0), 1},
         {},
         0.0};
  c.exact = dense_solution(c.matrix, c.lighting);
  return c;
}

TEST(Scenes, AreRightByEveryMethodThatAcceptsThem) {
  for (const SceneCase& scene : scene_cases()) {
    const Case c = lab_case(scene);
    for (std::size_t i = 0; i < c.exact.size(); ++i) {
      ASSERT_GE(c.exact[i], scene.low[i] * (1.0 - 1e-9)) << scene.name << ", cluster " << i;
      ASSERT_LE(c.exact[i], scene.high[i] * (1.0 + 1e-9)) << scene.name << ", cluster " << i;
    }
    std::cout << "| " << scene.name << " |";
    for (std::size_t m = 0; m < method_names().size(); ++m) {
      const Outcome outcome = run_method(c, Method(m));
      std::cout << " " << describe(outcome) << " |";
      EXPECT_NE(outcome.kind, OutcomeKind::wrong) << scene.name << ", " << method_names()[m];
      if (outcome.kind == OutcomeKind::refused) {
        EXPECT_EQ(Method(m), Method::conjugate_gradients) << scene.name << ": " << outcome.sentence;
      }
    }
    std::cout << "\n";
  }
}

// Half of its light leaves the room at once, through the floor that it lies on.
TEST(Scenes, ALightOnASurfaceLightsTheHalfSpaceBeforeIt) {
  const SceneCase scene = lamp_on_the_floor();
  std::vector<double> arrived;
  for (const Rgb& value : scene.lighting.direct) arrived.push_back(value.x);
  EXPECT_NEAR(flux(scene.model, arrived), 2.0 * kPi * 100.0, 0.01 * 2.0 * kPi * 100.0);
  const std::vector<double> radiosity = lab_case(scene).exact;
  std::vector<double> absorbed;
  for (const double value : radiosity) absorbed.push_back((1.0 - kAlbedo) / kAlbedo * value);
  EXPECT_NEAR(flux(scene.model, absorbed), flux(scene.model, arrived), 0.02 * flux(scene.model, arrived));
}

}  // namespace
}  // namespace relume::test
