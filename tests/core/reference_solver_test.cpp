// SPDX-License-Identifier: MIT
#include "core/reference_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <random>

#include "support/matrices.h"
#include "support/tiny_model.h"

namespace relume {
namespace {

using test::to_csr;
using test::uniform_lighting;

constexpr StopRule kTight{10000, 1e-12};

void expect_rgb(const Rgb& found, const Rgb& expected, double tolerance) {
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(found[channel], expected[channel], tolerance) << "channel " << channel;
  }
}

//  Two clusters and a sky patch:
//      K = [ 0    0.5 | 0.25 ]     rho = 0.5 0.4 0    M = 1 0 0    H = 0 2 4    sky 8 0 4
//          [ 0.5  0   | 0    ]           1/2 0.2 0.9      0 1 0        2 0 0
struct Drawn {
  CsrMatrix matrix = to_csr({{0, 0.5, 0.25}, {0.5, 0, 0}}, 3);
  Lighting lighting{{Rgb(0.5, 0.4, 0.0), Rgb(0.5, 0.2, 0.9)},
                    {Rgb(1, 0, 0), Rgb(0, 1, 0)},
                    {Rgb(0, 2, 4), Rgb(2, 0, 0)},
                    {Rgb(8, 0, 4)}};
};

TEST(Bounce, IsEmissionPlusAlbedoTimesAllThatArrives) {
  const Drawn drawn;
  const std::vector<Rgb> b = bounce(drawn.matrix, drawn.lighting, {Rgb(2, 4, 6), Rgb(8, 2, 4)});
  // Cluster 0, red: 1 + 0.5 (0 + 0.5 * 8 + 0.25 * 8) = 4; green: 0.4 (2 + 0.5 * 2) = 1.2; blue: albedo 0.
  expect_rgb(b[0], Rgb(4.0, 1.2, 0.0), 1e-15);
  // Cluster 1: 0.5 (2 + 0.5 * 2) = 1.5; 1 + 0.2 * 0.5 * 4 = 1.4; 0.9 * 0.5 * 6 = 2.7.
  expect_rgb(b[1], Rgb(1.5, 1.4, 2.7), 1e-15);
}

TEST(Gather, AddsWhatTheSendersSend) {
  const Drawn drawn;
  const CsrMatrix rows = to_csr({{0.5, 0.25, 0.25}, {0, 0, 1}, {0, 0, 0}}, 3);
  const std::vector<Rgb> irradiance = gather(rows, drawn.lighting, {Rgb(2, 4, 6), Rgb(8, 2, 4)});
  ASSERT_EQ(irradiance.size(), 3u);
  expect_rgb(irradiance[0], Rgb(5.0, 2.5, 5.0), 1e-15);
  expect_rgb(irradiance[1], Rgb(8.0, 0.0, 4.0), 1e-15);
  expect_rgb(irradiance[2], Rgb(0.0), 0.0);
}

TEST(ReferenceSolver, CountsBouncesFromEmissionAndDirectLight) {
  const Drawn drawn;
  const auto none = solve_reference(drawn.matrix, drawn.lighting, {0, 0.0});
  ASSERT_TRUE(none);
  EXPECT_EQ(none->bounces, 0u);
  expect_rgb(none->radiosity[0], Rgb(1.0, 0.8, 0.0), 1e-15);
  expect_rgb(none->radiosity[1], Rgb(1.0, 1.0, 0.0), 1e-15);
  const auto one = solve_reference(drawn.matrix, drawn.lighting, {1, 0.0});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->bounces, 1u);
  // Red of cluster 0: 1 + 0.5 (0.5 * 1 + 0.25 * 8) = 2.25; of cluster 1: 0.5 (2 + 0.5 * 1) = 1.25.
  EXPECT_NEAR(one->radiosity[0].x, 2.25, 1e-15);
  EXPECT_NEAR(one->radiosity[1].x, 1.25, 1e-15);
  // The last bounce changed red of cluster 0 by 1.25, the most of all, and 2.25 is the largest radiosity.
  EXPECT_NEAR(one->relative_residual, 1.25 / 2.25, 1e-15);
}

TEST(ReferenceSolver, UnitCubeWithOneEmittingFace) {
  Lighting lighting = uniform_lighting(6, Rgb(0.5), Rgb(0.0));
  lighting.exitance[0] = Rgb(1.0);
  const auto solution = solve_reference(test::cube_matrix(), lighting, kTight);
  ASSERT_TRUE(solution) << solution.error().message;
  const std::vector<Rgb>& b = solution->radiosity;
  // The figures are rounded to seven decimals.
  EXPECT_NEAR(b[0].x, 1.0909091, 1e-7);
  EXPECT_NEAR(b[1].x, 0.1817458, 1e-7);
  for (int side = 2; side < 6; ++side) EXPECT_NEAR(b[static_cast<std::size_t>(side)].x, 0.1818363, 1e-7);
  double sum = 0.0;
  for (const Rgb& value : b) sum += value.x;
  EXPECT_NEAR(sum, 2.0, 1e-8) << "1 / (1 - 0.5): all emitted power is accounted for";
}

TEST(ReferenceSolver, FurnaceOfAnyShape) {
  // Random rows that sum to exactly 1 as rays count them.
  std::mt19937_64 random(5);
  constexpr std::uint32_t kClusters = 12;
  test::DenseMatrix counts(kClusters, std::vector<double>(kClusters, 0.0));
  for (auto& row : counts) {
    for (int ray = 0; ray < 512; ++ray) row[random() % kClusters] += 1.0 / 512;
  }
  for (const double albedo : {0.5, 0.9, 0.99, 0.9999}) {
    const auto solution = solve_reference(
        to_csr(counts, kClusters), uniform_lighting(kClusters, Rgb(albedo), Rgb(0.5)), {1000000, 1e-9});
    ASSERT_TRUE(solution) << solution.error().message;
    for (const Rgb& b : solution->radiosity) EXPECT_NEAR(b.y * (1.0 - albedo) / 0.5, 1.0, 1e-9);
  }
}

TEST(ReferenceSolver, SphereWithAnEmittingCap) {
  // Inside a sphere F_ij = A_j / A for all i, so that B = M + rho / (1 - rho) mean(M).
  const std::vector<double> areas{0.5, 1.0, 2.0, 0.25, 3.25, 1.0};
  const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
  std::vector<double> row;
  for (const double area : areas) row.push_back(area / total);
  const CsrMatrix matrix = to_csr(test::DenseMatrix(6, row), 6);
  const Rgb albedo(0.2, 0.7, 0.95);
  Lighting lighting = uniform_lighting(6, albedo, Rgb(0.0));
  lighting.exitance[3] = Rgb(100.0, 50.0, 10.0);
  const auto solution = solve_reference(matrix, lighting, {10000, 1e-10});
  ASSERT_TRUE(solution) << solution.error().message;
  const Rgb mean = lighting.exitance[3] * areas[3] / total;
  for (std::size_t i = 0; i < 6; ++i) {
    expect_rgb(solution->radiosity[i], lighting.exitance[i] + albedo / (1.0 - albedo) * mean, 1e-8);
  }
}

struct RandomProblem {
  CsrMatrix matrix;
  Lighting lighting;
};

RandomProblem random_problem(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto clusters = static_cast<std::uint32_t>(5 + random() % 60);
  const auto patches = static_cast<std::uint32_t>(random() % 4);
  test::DenseMatrix dense(clusters, std::vector<double>(clusters + patches, 0.0));
  for (auto& row : dense) {
    for (double& value : row) value = unit(random) < 0.5 ? 0.0 : unit(random);
    const double sum = std::accumulate(row.begin(), row.end(), 0.0);
    const double target = unit(random);
    for (double& value : row) value *= sum > 0.0 ? target / sum : 0.0;
  }
  const auto random_rgb = [&](double scale) { return scale * Rgb(unit(random), unit(random), unit(random)); };
  RandomProblem problem{to_csr(dense, clusters + patches), {}};
  for (std::uint32_t i = 0; i < clusters; ++i) {
    problem.lighting.albedo.push_back(random_rgb(0.99));
    problem.lighting.exitance.push_back(random_rgb(i % 7 == 0 ? 100.0 : 0.0));
    problem.lighting.direct.push_back(random_rgb(10.0));
  }
  for (std::uint32_t p = 0; p < patches; ++p) problem.lighting.sky_radiosity.push_back(random_rgb(50.0));
  return problem;
}

/// (1 - rho K_c) B = M + rho (H + K_s b_s), solved by elimination.
Eigen::VectorXd solve_by_elimination(const RandomProblem& problem, int channel) {
  const auto n = static_cast<Eigen::Index>(problem.matrix.rows);
  const test::DenseMatrix dense = test::to_dense(problem.matrix);
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const double albedo = problem.lighting.albedo[row][channel];
    double arriving = problem.lighting.direct[row][channel];
    for (Eigen::Index j = 0; j < n; ++j) system(i, j) -= albedo * dense[row][static_cast<std::size_t>(j)];
    for (std::size_t p = 0; p < problem.lighting.sky_radiosity.size(); ++p) {
      arriving += dense[row][problem.matrix.rows + p] * problem.lighting.sky_radiosity[p][channel];
    }
    right(i) = problem.lighting.exitance[row][channel] + albedo * arriving;
  }
  return system.partialPivLu().solve(right);
}

TEST(ReferenceSolver, AgreesWithElimination) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RandomProblem problem = random_problem(seed);
    const auto solution = solve_reference(problem.matrix, problem.lighting, kTight);
    ASSERT_TRUE(solution) << solution.error().message;
    for (int channel = 0; channel < 3; ++channel) {
      const Eigen::VectorXd exact = solve_by_elimination(problem, channel);
      for (std::uint32_t i = 0; i < problem.matrix.rows; ++i) {
        EXPECT_NEAR(solution->radiosity[i][channel], exact(i), 1e-11 * exact.maxCoeff()) << "seed " << seed;
      }
    }
  }
}

TEST(ReferenceSolver, StopsAtTheFirstBounceWhoseBoundIsSmallEnough) {
  const RandomProblem problem = random_problem(11);
  std::vector<double> bounds;
  const auto observer = [&bounds](std::uint32_t bounces, double bound) {
    bounds.push_back(bound);
    EXPECT_EQ(bounces, bounds.size());
    return true;
  };
  const auto solution = solve_reference(problem.matrix, problem.lighting, {10000, 1e-4}, observer);
  ASSERT_TRUE(solution);
  ASSERT_EQ(solution->bounces, bounds.size());
  EXPECT_LE(bounds.back(), 1e-4);
  EXPECT_EQ(solution->error_bound, bounds.back());
  for (std::size_t k = 0; k + 1 < bounds.size(); ++k) EXPECT_GT(bounds[k], 1e-4);
}

TEST(ReferenceSolver, NeverStopsEarlyWithoutATolerance) {
  const auto solution =
      solve_reference(test::cube_matrix(), uniform_lighting(6, Rgb(0.5), Rgb(1.0)), {200, 0.0});
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->bounces, 200u);
}

TEST(ReferenceSolver, CanBeCancelled) {
  const auto solution = solve_reference(test::cube_matrix(), uniform_lighting(6, Rgb(0.5), Rgb(1.0)), kTight,
                                        [](std::uint32_t bounces, double) { return bounces < 3; });
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().code, ErrorCode::cancelled);
  EXPECT_EQ(solution.error().message, "cancelled after 3 bounces");
}

TEST(ReferenceSolver, DarknessStaysDark) {
  for (const std::uint32_t bounces : {0u, 100u}) {
    const auto solution =
        solve_reference(test::cube_matrix(), uniform_lighting(6, Rgb(0.5), Rgb(0.0)), {bounces, 1e-4});
    ASSERT_TRUE(solution);
    for (const Rgb& b : solution->radiosity) expect_rgb(b, Rgb(0.0), 0.0);
    EXPECT_EQ(solution->error_bound, 0.0);
    EXPECT_EQ(solution->relative_residual, 0.0);
  }
}

TEST(ReferenceSolver, LightOfTheSkyAlone) {
  Lighting lighting = uniform_lighting(1, Rgb(0.5), Rgb(0.0));
  lighting.sky_radiosity = {Rgb(4.0)};
  const auto solution = solve_reference(to_csr({{0.0, 0.75}}, 2), lighting, kTight);
  ASSERT_TRUE(solution);
  EXPECT_NEAR(solution->radiosity[0].x, 1.5, 1e-14);
}

TEST(ReferenceSolver, RefusesWhatDoesNotContract) {
  // Row sums of 1.2 (a matrix that breaks its promise): lambda = 1.08 with albedo 0.9.
  const CsrMatrix matrix = to_csr({{0.0, 1.2}, {1.2, 0.0}}, 2);
  const auto solution = solve_reference(matrix, uniform_lighting(2, Rgb(0.5, 0.9, 0.5), Rgb(1.0)), kTight);
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().code, ErrorCode::check_failed);
  EXPECT_NE(solution.error().message.find(
                "in channel 1 light grows by a factor of 1.08 or more at each bounce (the spectral radius of "
                "albedo x form factors lies between 1.08 and 1.08, expected below 1)"),
            std::string::npos)
      << solution.error().message;
}

TEST(ReferenceSolver, RefusesArraysThatDoNotFit) {
  const auto solution = solve_reference(test::cube_matrix(), uniform_lighting(5, Rgb(0.5), Rgb(1.0)), kTight);
  ASSERT_FALSE(solution);
  EXPECT_NE(solution.error().message.find("expected 6 clusters"), std::string::npos)
      << solution.error().message;
}

TEST(ReferenceMatrices, NumberSendersThroughAllSystems) {
  const ReferenceMatrices matrices = reference_matrices(test::tiny_model());
  // Senders: floor, lid, sky. Values in f32 but for the first two rows of gather (unorm16) and the second of
  // bounce (8 bits).
  const test::DenseMatrix bounce_rows = test::to_dense(matrices.bounce.rows);
  const test::DenseMatrix gather_rows = test::to_dense(matrices.gather.rows);
  const test::DenseMatrix expected_bounce{{0, 0.2, 0.5}, {0.2, 0, 0}};
  const test::DenseMatrix expected_gather{{0, 0.2, 0.5}, {0, 0.25, 0}, {0.2, 0, 0}};
  ASSERT_EQ(bounce_rows.size(), 2u);
  ASSERT_EQ(gather_rows.size(), 3u);
  const double step = 0.5 / 65535;
  for (std::size_t column = 0; column < 3; ++column) {
    for (std::size_t row = 0; row < 2; ++row) {
      EXPECT_NEAR(bounce_rows[row][column], expected_bounce[row][column], 1e-7);
    }
    for (std::size_t row = 0; row < 3; ++row) {
      EXPECT_NEAR(gather_rows[row][column], expected_gather[row][column], step);
    }
  }
}

TEST(ReferenceMatrices, SortColumnsWhateverTheOrderOfImports) {
  Model model = test::tiny_model();
  model.systems[0].imports = {{kSkySystem, 0}, {1, 0}};
  const CsrMatrix bounce_matrix = reference_bounce_matrix(model).rows;
  EXPECT_EQ(bounce_matrix.column_indices, (std::vector<std::uint32_t>{1, 2, 0}));
  EXPECT_FLOAT_EQ(static_cast<float>(bounce_matrix.values[0]), 0.5f);
}

// Two clusters in one system, which imports their node by 1/4 and 3/4, and two sky patches with theirs.
Model model_with_nodes() {
  Model model = test::tiny_model();
  model.sky_cells = {8, 9};
  model.sky_tree = {{{0, 2, 0}}, {0.5f, 0.5f}};
  System& floor = model.systems[0];
  floor.clusters.push_back(floor.clusters[0]);
  floor.tree = {{{0, 2, 0}}, {0.25f, 0.75f}};
  floor.imports = {{0, 2}, {kSkySystem, 2}};
  BlockMatrixBuilder builder(2, ValueCodec::f32);
  for (int row = 0; row < 2; ++row)
    builder.append_row(std::vector<std::uint16_t>{0, 1}, std::vector<double>{0.25, 0.5});
  floor.bounce = std::move(builder).finish();
  return model;
}

TEST(ReferenceMatrices, NodesFollowTheLeavesAndAreTheirMeans) {
  const ReferenceMatrices matrices = reference_matrices(model_with_nodes());
  // Leaves: floor 0 and 1, lid, sky 0 and 1; then the node of the floor, and that of the sky.
  EXPECT_EQ(matrices.bounce.rows.columns, 7u);
  const test::DenseMatrix p = test::to_dense(matrices.bounce.nodes);
  ASSERT_EQ(p.size(), 2u);
  EXPECT_EQ(p[0], (std::vector<double>{0.25, 0.75, 0, 0, 0}));
  EXPECT_EQ(p[1], (std::vector<double>{0, 0, 0, 0.5, 0.5}));
  const test::DenseMatrix k = test::to_dense(matrices.bounce.rows);
  EXPECT_EQ(k[0], (std::vector<double>{0, 0, 0, 0, 0, 0.25, 0.5}));

  Lighting lighting = test::uniform_lighting(3, Rgb(0.5), Rgb(0.0));
  lighting.sky_radiosity = {Rgb(2.0), Rgb(6.0)};
  // Node of the floor: (1 * 8 + 3 * 4) / 4 = 5; of the sky: 4. B = 0.5 (5 / 4 + 4 / 2).
  const std::vector<Rgb> b = bounce(matrices.bounce, lighting, {Rgb(8.0), Rgb(4.0), Rgb(0.0)});
  EXPECT_NEAR(b[0].x, 1.625, 1e-12);
}

TEST(SolveReference, NodesGiveWhatTheirLeavesGiveWhereRadiosityIsTheSame) {
  // Faces of a cube in two halves each; light and colour are the same on both halves, so that the radiosity
  // is too: form factors to the node of a face, or half of them to each half.
  const test::DenseMatrix cube = test::to_dense(test::cube_matrix());
  test::DenseMatrix leaves(12, std::vector<double>(12, 0.0)), nodes(12, std::vector<double>(18, 0.0)),
      p(6, std::vector<double>(12, 0.0));
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t face = 0; face < 6; ++face) {
      leaves[i][2 * face] = leaves[i][2 * face + 1] = 0.5 * cube[i / 2][face];
      nodes[i][12 + face] = cube[i / 2][face];
      p[face][2 * face] = p[face][2 * face + 1] = 0.5;
    }
  }
  Lighting lighting = test::uniform_lighting(12, Rgb(0.8, 0.5, 0.9), Rgb(0.0));
  for (std::size_t i = 0; i < 12; ++i) lighting.exitance[i] = Rgb(double(i / 2), 1.0, i < 2 ? 5.0 : 0.0);
  const auto full = solve_reference(test::to_csr(leaves, 12), lighting, {10000, 1e-10});
  const SenderMatrix cut(test::to_csr(nodes, 18), test::to_csr(p, 12));
  const auto with_nodes = solve_reference(cut, lighting, {10000, 1e-10});
  ASSERT_TRUE(full && with_nodes);
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_NEAR(full->radiosity[i].x, with_nodes->radiosity[i].x, 1e-8 * full->radiosity[i].x);
  // Both halves of a face receive alike, so the matrices have the same spectral radius.
  EXPECT_NEAR(contraction_bound(cut, lighting.albedo).quotient.z, 0.9, 1e-6);
}

TEST(StoredLighting, IsThatOfTheModel) {
  const Lighting lighting = stored_lighting(test::tiny_model());
  ASSERT_EQ(lighting.albedo.size(), 2u);
  expect_rgb(lighting.albedo[1], Rgb(0.5, 0.25, 0.75), 0.0);
  expect_rgb(lighting.exitance[0], Rgb(1.0, 0.0, 2.0), 0.0);
  expect_rgb(lighting.direct[1], Rgb(0.0), 0.0);
  EXPECT_EQ(lighting.sky_radiosity.size(), 1u);
  EXPECT_TRUE(check_lighting(test::tiny_model(), lighting));
}

TEST(CheckLighting, NamesArrayAndIndex) {
  const Model model = test::tiny_model();
  const auto complaint = [&model](auto&& breaker) {
    Lighting lighting = stored_lighting(model);
    breaker(lighting);
    const auto checked = check_lighting(model, lighting);
    return checked ? std::string("accepted") : checked.error().message;
  };
  EXPECT_EQ(complaint([](Lighting& l) { l.albedo[1].y = 1.0; }),
            "lighting: albedo[1], channel 1: expected a finite value from 0 to 0.9999, found 1");
  EXPECT_EQ(complaint([](Lighting& l) { l.exitance[0].x = std::nan(""); }),
            "lighting: exitance[0], channel 0: expected a finite value from 0 to 1e+30, found nan");
  EXPECT_EQ(complaint([](Lighting& l) { l.direct[1].z = -1.0; }),
            "lighting: direct[1], channel 2: expected a finite value from 0 to 1e+30, found -1");
  EXPECT_EQ(complaint([](Lighting& l) { l.sky_radiosity.clear(); }),
            "lighting: expected 1 entries in sky_radiosity, found 0");
}

}  // namespace
}  // namespace relume
