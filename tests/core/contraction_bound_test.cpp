// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "core/reference_solver.h"
#include "support/matrices.h"

namespace relume {
namespace {

using test::DenseMatrix;

/// One channel's problem in all three channels.
struct Problem {
  const char* name;
  DenseMatrix rows;
  std::vector<double> albedo;
  std::vector<double> exitance;
};

Lighting lighting_of(const Problem& problem) {
  Lighting lighting = test::uniform_lighting(problem.albedo.size(), Rgb(0.0), Rgb(0.0));
  for (std::size_t i = 0; i < problem.albedo.size(); ++i) {
    lighting.albedo[i] = Rgb(problem.albedo[i]);
    lighting.exitance[i] = Rgb(problem.exitance[i]);
  }
  return lighting;
}

CsrMatrix matrix_of(const Problem& problem) {
  return test::to_csr(problem.rows, static_cast<std::uint32_t>(problem.rows.size()));
}

Eigen::MatrixXd reflection(const Problem& problem) {
  const auto n = static_cast<Eigen::Index>(problem.rows.size());
  Eigen::MatrixXd matrix(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto row = static_cast<std::size_t>(i);
      matrix(i, j) = problem.albedo[row] * problem.rows[row][static_cast<std::size_t>(j)];
    }
  }
  return matrix;
}

double spectral_radius(const Problem& problem) {
  return reflection(problem).eigenvalues().cwiseAbs().maxCoeff();
}

std::vector<double> exact_radiosity(const Problem& problem) {
  const Eigen::MatrixXd matrix = reflection(problem);
  const Eigen::VectorXd emitted = Eigen::Map<const Eigen::VectorXd>(
      problem.exitance.data(), static_cast<Eigen::Index>(problem.exitance.size()));
  const Eigen::VectorXd b =
      (Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()) - matrix).partialPivLu().solve(emitted);
  return {b.begin(), b.end()};
}

Problem cube(double albedo) {
  Problem problem{"cube", test::to_dense(test::cube_matrix()), std::vector<double>(6, albedo),
                  std::vector<double>(6, 0.0)};
  problem.exitance[0] = 1.0;
  return problem;
}

/// Two rooms of `size` clusters each, every cluster seeing its own room alike but for a share `door` that it
/// sees of the other; the lamp is in the first.
Problem two_rooms(double door, double albedo_first, double albedo_second) {
  constexpr std::size_t kSize = 8;
  Problem problem{"two rooms",
                  DenseMatrix(2 * kSize, std::vector<double>(2 * kSize)),
                  {},
                  std::vector<double>(2 * kSize)};
  for (std::size_t i = 0; i < 2 * kSize; ++i) {
    const bool first = i < kSize;
    for (std::size_t j = 0; j < 2 * kSize; ++j) {
      problem.rows[i][j] = (first == (j < kSize) ? 1.0 - door : door) / kSize;
    }
    problem.albedo.push_back(first ? albedo_first : albedo_second);
  }
  problem.exitance[0] = 1.0;
  return problem;
}

/// Random rows that sum to 1, random albedos, every fifth cluster black, and every seventh emitting.
Problem random_room(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const std::size_t size = 20 + random() % 40;
  Problem problem{"random", DenseMatrix(size, std::vector<double>(size)), {}, {}};
  for (std::size_t i = 0; i < size; ++i) {
    double sum = 0.0;
    for (double& value : problem.rows[i]) sum += value = std::pow(unit(random), 4.0);
    for (double& value : problem.rows[i]) value /= sum;
    problem.albedo.push_back(i % 5 == 4 ? 0.0 : 0.3 + 0.65 * unit(random));
    problem.exitance.push_back(i % 7 == 0 ? unit(random) : 0.0);
  }
  return problem;
}

std::vector<Problem> all_problems() {
  std::vector<Problem> problems{cube(0.1),
                                cube(0.9),
                                cube(0.99),
                                two_rooms(0.01, 0.8, 0.8),
                                two_rooms(0.001, 0.5, 0.9),
                                two_rooms(0.0, 0.9, 0.8),
                                two_rooms(0.0, 0.5, 0.95)};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) problems.push_back(random_room(seed));
  return problems;
}

struct ErrorAndBound {
  double error;
  double bound;
};

ErrorAndBound after_bounces(const Problem& problem, std::uint32_t bounces) {
  const auto solution = solve_reference(matrix_of(problem), lighting_of(problem), {bounces, 0.0});
  const std::vector<double> exact = exact_radiosity(problem);
  double error = 0.0;
  double top = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    error = std::max(error, std::abs(solution->radiosity[i].x - exact[i]));
    top = std::max(top, solution->radiosity[i].x);
  }
  return {error / top, solution->error_bound};
}

TEST(ContractionBound, HoldsAfterAnyNumberOfBounces) {
  for (const Problem& problem : all_problems()) {
    for (const std::uint32_t bounces : {0u, 1u, 2u, 3u, 5u, 10u, 20u, 50u, 100u, 300u}) {
      const ErrorAndBound found = after_bounces(problem, bounces);
      // What elimination itself is off by.
      EXPECT_GE(found.bound, found.error - 1e-14) << problem.name << ", " << bounces << " bounces";
    }
  }
}

TEST(ContractionBound, IsSharpWhereTheSlowestModeIsLit) {
  std::vector<Problem> problems{cube(0.5), cube(0.9), cube(0.99), two_rooms(0.01, 0.8, 0.8),
                                two_rooms(0.01, 0.9, 0.5)};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) problems.push_back(random_room(seed));
  for (const Problem& problem : problems) {
    for (const std::uint32_t bounces : {5u, 10u, 20u}) {
      const ErrorAndBound found = after_bounces(problem, bounces);
      if (found.error < 1e-12) continue;
      EXPECT_LE(found.bound, 3.0 * found.error) << problem.name << ", " << bounces << " bounces";
    }
  }
}

TEST(ContractionBound, BracketsTheSpectralRadius) {
  for (const Problem& problem : all_problems()) {
    const ContractionBound bound = contraction_bound(matrix_of(problem), lighting_of(problem).albedo);
    const double radius = spectral_radius(problem);
    EXPECT_GE(bound.quotient.x, radius - 1e-13) << problem.name;
    EXPECT_LE(bound.lower_quotient.x, radius + 1e-13) << problem.name;
    EXPECT_LE(1.0 / (1.0 - bound.quotient.x), 1.5 / (1.0 - radius)) << problem.name;
    double top = 0.0;
    for (const Rgb& weight : bound.weights) {
      EXPECT_GT(weight.x, 0.0);
      top = std::max(top, weight.x);
    }
    EXPECT_NEAR(top, 1.0, 1e-15) << problem.name;
  }
}

TEST(ContractionBound, ChannelsAreTheirOwn) {
  const CsrMatrix matrix = test::cube_matrix();
  const ContractionBound bound = contraction_bound(matrix, std::vector<Rgb>(6, Rgb(0.0, 0.25, 0.99)));
  EXPECT_EQ(bound.quotient.x, 0.0);
  EXPECT_NEAR(bound.quotient.y, 0.25, 1e-12);
  EXPECT_NEAR(bound.quotient.z, 0.99, 1e-12);
  EXPECT_EQ(bound.lower_quotient.x, 0.0);
  EXPECT_NEAR(bound.lower_quotient.y, 0.25, 1e-12);
}

TEST(ContractionBound, SkyColumnsDoNotFeedBack) {
  const CsrMatrix matrix = test::to_csr({{0.0, 0.25, 0.75}, {0.25, 0.0, 0.75}}, 3);
  EXPECT_NEAR(contraction_bound(matrix, std::vector<Rgb>(2, Rgb(0.8))).quotient.x, 0.2, 1e-12);
}

TEST(ContractionBound, FindsThatAModelContractsAlthoughOneRowDoesNot) {
  // Row sums times albedo of 0.2 and 1.8: the product is 0.36, the spectral radius 0.6.
  const CsrMatrix matrix = test::to_csr({{0.0, 0.2}, {1.8, 0.0}}, 2);
  const ContractionBound bound = contraction_bound(matrix, std::vector<Rgb>(2, Rgb(1.0)));
  EXPECT_GE(bound.quotient.x, 0.6);
  EXPECT_LT(bound.quotient.x, 1.0);
}

//      K = [ 0 0.5 ; 0.5 0 ], albedo 0.8: the spectral radius is 0.4, and ones are its eigenvector.
TEST(ContractionBound, CoversTheRoundingOfItsProducts) {
  constexpr double kRounding = 1e-3;
  const ClusterProduct rounded = [](const std::vector<Rgb>& v) -> Result<std::vector<Rgb>> {
    return std::vector<Rgb>{0.4 * (1.0 - kRounding) * v[1], 0.4 * (1.0 - kRounding) * v[0]};
  };
  const auto bound = contraction_bound(rounded, std::vector<Rgb>(2, Rgb(0.8)), kRounding);
  ASSERT_TRUE(bound) << bound.error().message;
  EXPECT_NEAR(bound->quotient.x, 0.4, 1e-6);
  EXPECT_LE(bound->lower_quotient.x, 0.4);
}

TEST(ContractionBound, GivesTheErrorOfAProduct) {
  const ClusterProduct lost = [](const std::vector<Rgb>&) -> Result<std::vector<Rgb>> {
    return fail(ErrorCode::no_device, "the device was lost");
  };
  const auto bound = contraction_bound(lost, std::vector<Rgb>(2, Rgb(0.8)), 0.0);
  ASSERT_FALSE(bound);
  EXPECT_EQ(bound.error().message, "the device was lost");
}

}  // namespace
}  // namespace relume
