// SPDX-License-Identifier: MIT
//
// Coefficients of light probes against closed forms and the independent path tracer.
#include <gtest/gtest.h>

#include <cmath>

#include "core/probe_coefficients.h"
#include "support/scene_builder.h"
#include "verification/path_tracer.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

using Points = std::vector<glm::dvec3>;

PrecomputeOptions options(double cluster_size, const Points& points) {
  PrecomputeOptions result;
  result.cluster_size = cluster_size;
  result.texel_size = cluster_size / 2;
  for (const glm::dvec3& point : points)
    result.probes.push_back({std::to_string(result.probes.size()), point});
  return result;
}

std::vector<ProbeCoefficients> probes_in(const Scene& scene, const PrecomputeOptions& how) {
  const Model model = precompute_or_throw(scene, how);
  return solve_probes(model, light(model, scene, {scene.lights, {}}));
}

/// The harmonics of a unit direction, by hand.
std::array<double, 9> harmonics(const glm::dvec3& d) {
  return {0.2820948,
          0.4886025 * d.y,
          0.4886025 * d.z,
          0.4886025 * d.x,
          1.0925484 * d.x * d.y,
          1.0925484 * d.y * d.z,
          0.3153916 * (3.0 * d.z * d.z - 1.0),
          1.0925484 * d.x * d.z,
          0.5462742 * (d.x * d.x - d.y * d.y)};
}

TEST(LightProbes, InAFurnaceSeeItsRadianceAlone) {
  // Albedo 0.5 and radiance 3 everywhere: 6 from all sides, of which only Y00 is left: 6 sqrt(4 pi).
  const auto found = probes_in(furnished_room({0.5, 3.0}), options(0.5, {{0.7, 1.2, 0.6}, {2.5, 1.9, 2.0}}));
  const double expected = 6.0 * std::sqrt(4.0 * kPi);
  for (const ProbeCoefficients& probe : found) {
    EXPECT_NEAR(probe[0].g, expected, 1e-4 * expected);
    for (std::size_t h = 1; h < kProbeHarmonics; ++h) EXPECT_NEAR(probe[h].g, 0.0, 2e-3 * expected) << h;
  }
}

TEST(LightProbes, AboveAnEndlessFloorSeeHalfASphere) {
  // Radiance 1 from below: 2 pi Y00, and for y the integral of sqrt(3 / 4 pi) y over it: -sqrt(3 pi) / 2. All
  // of the second band is 0.
  SceneBuilder builder;
  const double far = 4000.0;
  builder.add_quad("floor", builder.material("floor", Rgb(0.0), Rgb(1.0)),
                   {glm::dvec3{-far, 0, -far}, {-far, 0, far}, {far, 0, far}, {far, 0, -far}});
  const auto found = probes_in(builder.scene(), options(400.0, {{0.0, 1.0, 0.0}})).at(0);
  EXPECT_NEAR(found[0].g, std::sqrt(kPi), 2e-3);
  EXPECT_NEAR(found[1].g, -std::sqrt(3.0 * kPi) / 2.0, 2e-3);
  // Seen from its middle, the floor is one sender or four, in all directions below: parts have to tell them.
  for (std::size_t h = 2; h < kProbeHarmonics; ++h) EXPECT_NEAR(found[h].g, 0.0, 0.03) << h;
}

TEST(LightProbes, SeeASmallLampWhereItIs) {
  // A lamp of 5 x 5 cm and radiance 1000 that faces the probe from 3 m: solid angle 0.0025 / 9.
  const glm::dvec3 d(2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0), middle = 3.0 * d;
  const glm::dvec3 u = glm::normalize(glm::cross(d, glm::dvec3(0, 1, 0))), v = glm::cross(d, u);
  SceneBuilder builder;
  const auto lamp = builder.material("lamp", Rgb(0.0), Rgb(1000.0));
  const double r = 0.025;
  builder.add_quad(
      "lamp", lamp,
      {middle - r * u - r * v, middle - r * u + r * v, middle + r * u + r * v, middle + r * u - r * v});
  const auto dark = builder.material("dark", Rgb(0.0));
  builder.add_room("room", dark, glm::dvec3(-4.0), glm::dvec3(4.0));
  const auto found = probes_in(builder.scene(), options(1.0, {glm::dvec3(0.0)})).at(0);
  const auto y = harmonics(d);
  const double arriving = 1000.0 * 0.0025 / 9.0;
  for (std::size_t h = 0; h < kProbeHarmonics; ++h) {
    EXPECT_NEAR(found[h].g, arriving * y[h], 0.005 * arriving) << h;
  }
}

/// Root mean square over probes, harmonics and channels of the difference, relative to the Y00 of each.
double error_against_paths(const Scene& scene, const Points& points, const PathOptions& paths,
                           double cluster_size) {
  const auto found = probes_in(scene, options(cluster_size, points));
  const PathTracer tracer(scene, scene.lights);
  double squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto expected = tracer.incident(points[i], paths);
    for (std::size_t h = 0; h < kProbeHarmonics; ++h) {
      const Rgb off = (found[i][h] - expected[h].mean) / expected[0].mean;
      squares += glm::dot(off, off);
    }
  }
  return std::sqrt(squares / (27.0 * double(points.size())));
}

TEST(LightProbes, OfAnEmptyRoomAgreeWithPaths) {
  const Points points{{0.5, 1.2, 0.6}, {2.0, 1.6, 2.1}, {3.4, 0.4, 3.3}, {1.0, 2.2, 2.9}};
  const double error = error_against_paths(lamp_room(0.6, 0.5), points, {8, 2500}, 0.25);
  RecordProperty("error", std::to_string(error));
  EXPECT_LE(error, 0.02);
}

TEST(LightProbes, OfFurnishedRoomsAgreeWithPaths) {
  const Points points{{0.6, 1.4, 0.7}, {2.0, 1.2, 1.6}, {3.5, 0.5, 2.8}, {5.0, 1.5, 1.0}, {6.9, 2.0, 2.4}};
  const double error = error_against_paths(two_rooms(), points, {8, 2500}, 0.25);
  RecordProperty("error", std::to_string(error));
  EXPECT_LE(error, 0.02);
}

TEST(LightProbes, InsideGeometryAreInvalid) {
  SceneBuilder builder;
  const auto wall = builder.material("wall", Rgb(0.5));
  builder.add_room("room", wall, glm::dvec3(0.0), glm::dvec3(4.0, 3.0, 4.0));
  builder.add_box("box", wall, {1, 0.5, 1}, {2, 1.5, 2}, SceneBuilder::Facing::outward);
  const Model model = precompute_or_throw(
      builder.scene(), options(0.5, {{1.5, 1.0, 1.5}, {2.05, 1.0, 1.5}, {-0.5, 1.0, 1.0}, {3.0, 1.0, 3.0}}));
  std::vector<std::uint32_t> flags(4);
  for (const System& system : model.systems) {
    for (const Probe& probe : system.probes) flags[probe.name] = probe.flags;
  }
  EXPECT_EQ(flags, (std::vector<std::uint32_t>{kProbeInvalid, 0, kProbeInvalid, 0}));
}

TEST(LightProbes, DoNotDependOnThreadsOrOnEachOther) {
  PrecomputeOptions one = options(0.5, {{0.7, 1.2, 0.6}, {2.5, 1.9, 2.0}, {3.5, 0.5, 2.8}}), two = one;
  one.threads = 1, two.threads = 2;
  two.probes.erase(two.probes.begin());
  const auto all = probes_in(two_rooms(), one), part = probes_in(two_rooms(), two);
  for (std::size_t h = 0; h < kProbeHarmonics; ++h) {
    EXPECT_EQ(all[1][h], part[0][h]);
    EXPECT_EQ(all[2][h], part[1][h]);
  }
}

}  // namespace
}  // namespace relume::test
