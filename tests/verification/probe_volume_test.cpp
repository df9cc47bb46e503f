// SPDX-License-Identifier: MIT
//
// Light between probes: none through walls, and as good as a denser grid where they are placed automatically.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "core/probe_coefficients.h"
#include "core/probe_volume.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

const std::array<glm::dvec3, 6> kNormals{glm::dvec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0},
                                         {0, -1, 0},          {0, 0, 1},  {0, 0, -1}};

std::vector<glm::dvec3> random_points(std::size_t count, const glm::dvec3& lower, const glm::dvec3& upper) {
  std::mt19937_64 engine(7);
  const auto unit = [&] { return double(engine() >> 11) * 0x1p-53; };
  std::vector<glm::dvec3> points;
  while (points.size() < count) {
    const double x = unit(), y = unit(), z = unit();
    points.push_back(lower + (upper - lower) * glm::dvec3(x, y, z));
  }
  return points;
}

PrecomputeOptions options(double cluster_size) {
  PrecomputeOptions result;
  result.cluster_size = cluster_size;
  result.texel_size = cluster_size / 2;
  result.quality = 256;
  return result;
}

/// Irradiance from six sides at each point; `missed`: points that no probe speaks for.
std::vector<Rgb> between_probes(const Model& model, const RunTimeLighting& lit,
                                const std::vector<glm::dvec3>& points, std::size_t& missed) {
  const std::vector<ProbeCoefficients> probes = solve_probes(model, lit);
  std::vector<Rgb> irradiance;
  missed = 0;
  for (const glm::dvec3& point : points) {
    const WeightedProbes at = probes_at(model.probe_volume, glm::vec3(point - model.origin));
    float sum = 0.0f;
    for (const float weight : at.weights) sum += weight;
    if (!(sum > 0.0f)) ++missed;
    for (const glm::dvec3& normal : kNormals) irradiance.push_back(probe_irradiance(probes, at, normal));
  }
  return irradiance;
}

struct Wall {
  bool automatic = false;  ///< placement; else a grid
  double thickness = 0.1;  ///< m
};

class WallTest : public testing::TestWithParam<Wall> {};

// Two closed rooms with a wall between them; only the one at x < 2 has a light.
TEST_P(WallTest, NothingBeyondItChangesWithTheLightBehindIt) {
  const double thickness = GetParam().thickness;
  const Scene rooms = sealed_rooms(thickness);
  Light bulb;
  bulb.intensity = Rgb(100.0);
  bulb.position = {1.0, 1.0, 1.0};
  PrecomputeOptions how = options(0.25);
  how.auto_probes = GetParam().automatic;
  if (!GetParam().automatic) how.probe_spacing = 0.6;
  const Model model = precompute_or_throw(rooms, how);
  const double edge = 0.002;
  const auto beyond = random_points(1000, {2.0 + thickness + edge, edge, edge},
                                    {5.1 + thickness - edge, 2.0 - edge, 2.0 - edge});
  const auto lit_side = random_points(100, glm::dvec3(0.05), glm::dvec3(1.95));
  std::size_t missed = 0;
  const auto at_lamp = between_probes(model, light(model, rooms, {{bulb}, {}}), lit_side, missed);
  EXPECT_LE(missed, lit_side.size() / 50);
  double mean = 0.0;
  for (const Rgb& value : at_lamp) mean += value.g / double(at_lamp.size());
  EXPECT_GT(mean, 0.0);
  const auto before = between_probes(model, light(model, rooms, {}), beyond, missed);
  const auto after = between_probes(model, light(model, rooms, {{bulb}, {}}), beyond, missed);
  RecordProperty("missed", std::to_string(missed));
  RecordProperty("probes", std::to_string(model.probe_names.size()));
  EXPECT_LE(missed, beyond.size() / 50);
  for (std::size_t i = 0; i < before.size(); ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_LE(std::abs(after[i][c] - before[i][c]), 1e-6 * mean) << i / 6;
  }
}

INSTANTIATE_TEST_SUITE_P(Placement, WallTest,
                         testing::Values(Wall{false, 0.1}, Wall{false, 0.01}, Wall{true, 0.01}));

/// What interpolation costs against probes at the points themselves: irradiance from six sides, relative to
/// what there is (or a tenth of its root mean square), root mean square over the points.
struct Interpolation {
  std::size_t probes = 0, missed = 0;
  double error = 0.0;
};

Interpolation interpolate(const Scene& scene, const PrecomputeOptions& how,
                          const std::vector<glm::dvec3>& points, const std::vector<Rgb>& truth) {
  const Model model = precompute_or_throw(scene, how);
  Interpolation result;
  const auto found = between_probes(model, light(model, scene, {scene.lights, {}}), points, result.missed);
  result.probes = model.probe_names.size();
  double mean = 0.0;
  for (const Rgb& value : truth) mean += glm::dot(value, value) / double(truth.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double off = 0.0, whole = 0.0;
    for (std::size_t n = i * kNormals.size(); n < (i + 1) * kNormals.size(); ++n) {
      off += glm::dot(found[n] - truth[n], found[n] - truth[n]);
      whole += glm::dot(truth[n], truth[n]);
    }
    squares += off / (whole + 0.01 * mean * kNormals.size());
  }
  result.error = std::sqrt(squares / double(points.size()));
  return result;
}

bool inside_box(const glm::dvec3& p) {
  for (const Footprint& box : two_rooms_footprints()) {
    if (p.x > box.x0 - 0.05 && p.x < box.x1 + 0.05 && p.z > box.z0 - 0.05 && p.z < box.z1 + 0.05) return true;
  }
  return p.x > 3.95 && p.x < 4.15;
}

// Errors of grids fall by steps, as they happen to meet the lamps; one that is this good needs more than
// twice as many.
TEST(ProbePlacement, HasHalfOfTheErrorOfAGridOfMoreProbes) {
  const Scene scene = two_rooms();
  std::vector<glm::dvec3> points = random_points(400, glm::dvec3(0.05), {7.55, 2.55, 3.15});
  std::erase_if(points, inside_box);
  PrecomputeOptions how = options(0.25);
  for (const glm::dvec3& point : points) how.probes.push_back({"", point});
  const Model exact = precompute_or_throw(scene, how);
  std::vector<Rgb> truth;
  WeightedProbes one;
  one.probes.fill(kNoProbe);
  one.weights[0] = 1.0f;
  const auto coefficients = solve_probes(exact, light(exact, scene, {scene.lights, {}}));
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    one.probes[0] = i;
    for (const glm::dvec3& normal : kNormals) truth.push_back(probe_irradiance(coefficients, one, normal));
  }
  how.probes.clear();
  how.auto_probes = true;
  const Interpolation placed = interpolate(scene, how, points, truth);
  RecordProperty("placed_probes", std::to_string(placed.probes));
  RecordProperty("placed_error", std::to_string(placed.error));
  RecordProperty("placed_missed", std::to_string(placed.missed));
  how.auto_probes = false;
  how.probe_spacing = 0.35;
  const Interpolation grid = interpolate(scene, how, points, truth);
  RecordProperty("grid_probes", std::to_string(grid.probes));
  RecordProperty("grid_error", std::to_string(grid.error));
  EXPECT_EQ(placed.missed, 0u);
  EXPECT_LE(placed.probes, grid.probes);
  EXPECT_LE(2.0 * placed.error, grid.error);
}

}  // namespace
}  // namespace relume::test
