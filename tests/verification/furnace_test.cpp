// SPDX-License-Identifier: MIT
//
// In a closed room of uniform exitance M and albedo rho every radiosity is M / (1 - rho), whatever the shape.
#include <gtest/gtest.h>

#include "core/methods/methods.h"
#include "core/reference_solver.h"
#include "support/matrices.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

PrecomputeOptions options(double cluster_size) {
  PrecomputeOptions result;
  result.cluster_size = cluster_size;
  result.texel_size = cluster_size / 2;
  result.quality = 128;
  result.max_albedo = 0.9999;
  return result;
}

/// Where furniture stands on the floor, and legs carry the table: such contact sees nothing of the room.
bool hidden(const Cluster& cluster) {
  const auto inside = [&](double x0, double x1, double z0, double z1) {
    const double slack = 1e-3;
    return cluster.centroid.x > x0 - slack && cluster.centroid.x < x1 + slack &&
           cluster.centroid.z > z0 - slack && cluster.centroid.z < z1 + slack;
  };
  const bool on_floor = cluster.centroid.y < 1e-3f,
             under_table = std::abs(cluster.centroid.y - 0.72f) < 1e-3f;
  if (on_floor && inside(3.0, 3.6, 0.3, 0.8)) return true;
  return (on_floor || under_table) && (inside(1.25, 1.3, 1.05, 1.1) || inside(2.3, 2.35, 1.05, 1.1) ||
                                       inside(1.25, 1.3, 1.7, 1.75) || inside(2.3, 2.35, 1.7, 1.75));
}

void expect_furnace(const Model& model, double albedo, bool furnished) {
  const double exitance = 2.0, expected = exitance / (1.0 - albedo);
  const auto offsets = cluster_offsets(model);
  const Lighting lighting = uniform_lighting(offsets.back(), Rgb(albedo), Rgb(exitance));
  const ReferenceMatrices matrices = reference_matrices(model);
  StopRule rule;
  rule.tolerance = 1e-6;
  const auto solution = solve_reference(matrices.bounce, lighting, rule);
  ASSERT_TRUE(solution) << solution.error().message;
  std::size_t checked = 0;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    for (std::size_t c = 0; c < model.systems[s].clusters.size(); ++c) {
      const Cluster& cluster = model.systems[s].clusters[c];
      if (furnished && hidden(cluster)) continue;
      ++checked;
      ASSERT_NEAR(solution->radiosity[offsets[s] + c].g, expected, 1e-3 * expected)
          << "albedo " << albedo << ", cluster " << c << " of node " << model.nodes[cluster.node].path
          << " at " << cluster.centroid.x << ' ' << cluster.centroid.y << ' ' << cluster.centroid.z;
    }
  }
  EXPECT_GT(checked, 100u);
}

void expect_furnaces(const Scene& scene, double cluster_size, bool furnished = false) {
  const Model model = precompute_or_throw(scene, options(cluster_size));
  for (const double albedo : {0.5, 0.9, 0.99}) expect_furnace(model, albedo, furnished);
}

TEST(Furnace, Box) {
  expect_furnaces(box_room({}), 0.5);
}

// 32 rays a lumel: conjugate gradients are refused for rows of such rays, and right for their projection,
// whose sums still are 1.
TEST(Furnace, BoxOfReciprocalRows) {
  PrecomputeOptions chosen = options(0.5);
  chosen.quality = 32;
  const Model noisy = precompute_or_throw(box_room({}), chosen);
  chosen.reciprocal = true;
  PrecomputeReport report;
  const Model model = precompute_or_throw(box_room({}), chosen, &report);
  for (const double albedo : {0.5, 0.9, 0.99}) expect_furnace(model, albedo, false);
  ASSERT_TRUE(report.projection);
  EXPECT_GT(report.projection->asymmetry, 0.01);
  EXPECT_EQ(report.projection->left, 0.0);

  const Lighting lighting =
      uniform_lighting(std::uint32_t(model.systems[0].clusters.size()), Rgb(0.95), Rgb(2.0));
  const auto by_gradients = [&](const Model& of) {
    const ReferenceMatrices matrices = reference_matrices(of);
    const auto problem = make_bounce_problem(matrices.bounce, lighting, cluster_areas(of));
    return solve_by_conjugate_gradients(problem.value(), {1000, 1e-4});
  };
  EXPECT_FALSE(by_gradients(noisy));
  const auto solution = by_gradients(model);
  ASSERT_TRUE(solution) << solution.error().message;
  EXPECT_EQ(solution->fallback, "");
  EXPECT_LT(solution->bounces, 20u);
  for (const Rgb& value : solution->radiosity) ASSERT_NEAR(value.g, 2.0 / 0.05, 1e-3 * 40.0);
}

TEST(Furnace, BoxWhoseMaterialMayEmit) {
  expect_furnaces(box_room({0.5, 1.0}), 0.5);
}

TEST(Furnace, BoxInThreeSystems) {
  Scene scene = box_room({});
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    scene.nodes[n].extras.system = std::array{"x", "y", "z"}[n / 2];
  for (const std::uint32_t budget : {0u, 24u}) {
    PrecomputeOptions chosen = options(0.5);
    chosen.budget = budget;
    const Model model = precompute_or_throw(scene, chosen);
    ASSERT_EQ(model.systems.size(), 3u);
    for (const double albedo : {0.5, 0.9, 0.99}) expect_furnace(model, albedo, false);
  }
}

TEST(Furnace, LShape) {
  expect_furnaces(l_room({}), 0.5);
}

TEST(Furnace, Sphere) {
  expect_furnaces(sphere_room(24, 2.0, {}, {}), 0.25);
}

TEST(Furnace, FurnishedRoom) {
  expect_furnaces(furnished_room({}), 0.2, true);
}

TEST(Furnace, SphereWithAnEmittingCap) {
  // Inside a sphere every element sees every other by its share of the area, so B = M + rho / (1 - rho)
  // mean(M); of its 48 x 96 facets each deviates from that by less than (pi / 48)^2 / 4 = 0.1 %.
  const double albedo = 0.7, exitance = kPi;
  const Scene scene = sphere_room(48, 0.8, {albedo, 0.0}, {albedo, 1.0});
  PrecomputeOptions chosen = options(0.15);
  chosen.quality = 1024;
  const Model model = precompute_or_throw(scene, chosen);
  const auto lit = light(model, scene, {});
  const auto solution = solve_reference(reference_bounce_matrix(model), lit.lighting, {10000, 1e-6});
  ASSERT_TRUE(solution) << solution.error().message;
  double cap = 0.0, all = 0.0, reflected = 0.0;
  for (const Cluster& cluster : model.systems.at(0).clusters) {
    all += cluster.area;
    if (model.materials[cluster.material].name == "cap") cap += cluster.area;
  }
  const double expected = albedo / (1.0 - albedo) * exitance * cap / all;
  for (std::size_t c = 0; c < model.systems[0].clusters.size(); ++c) {
    const double own = solution->radiosity[c].r - lit.lighting.exitance[c].r;
    reflected += own * model.systems[0].clusters[c].area;
    // Noise of 4 x 512 rays, of which one in ten meets the cap: 2.5 % of the tenth's first bounce if they
    // were random.
    ASSERT_NEAR(own, expected, 0.02 * expected) << "cluster " << c;
  }
  EXPECT_NEAR(reflected / all, expected, 1e-3 * expected);
}

}  // namespace
}  // namespace relume::test
