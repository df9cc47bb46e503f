// SPDX-License-Identifier: MIT
//
// GMRES over near couplings and groups of clusters.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "core/methods/alike_groups.h"
#include "core/methods/near_and_far.h"
#include "core/methods/rgb_lu.h"
#include "stability/lab.h"
#include "support/box_rooms.h"

namespace relume::test {
namespace {

constexpr std::uint32_t kGaps = 60;
constexpr double kInGap = 0.95;  // of the view of each side of a gap is the other side

/// A box room whose walls have narrow gaps, two sides each: a side sees the other, and past it what the patch
/// of the wall sees from which the gap starts. Reciprocal where the gap's mouth is small against the patch.
CsrMatrix with_gaps(const BoxRooms& boxes) {
  const auto n = static_cast<std::uint32_t>(boxes.size());
  CsrMatrix matrix = boxes.matrix;
  matrix.rows = matrix.columns = n + 2 * kGaps;
  const auto add = [&matrix](std::uint32_t column, double value) {
    matrix.column_indices.push_back(column);
    matrix.values.push_back(value);
  };
  for (std::uint32_t side = 0; side < 2 * kGaps; ++side) {
    const std::uint32_t patch = side / 2 % n;
    for (auto e = boxes.matrix.row_offsets[patch]; e < boxes.matrix.row_offsets[patch + 1]; ++e)
      add(boxes.matrix.column_indices[e], (1.0 - kInGap) * boxes.matrix.values[e]);
    add(n + (side ^ 1u), kInGap);
    matrix.row_offsets.push_back(matrix.values.size());
  }
  return matrix;
}

Lighting lit_from_first(std::size_t clusters, double albedo) {
  Lighting lighting;
  lighting.albedo.assign(clusters, Rgb(albedo));
  lighting.exitance.assign(clusters, Rgb(0.0));
  lighting.direct.assign(clusters, Rgb(0.0));
  lighting.exitance[0] = Rgb(100.0);
  return lighting;
}

/// Both kinds of slow light at once: in gaps it fades by 0.95 albedo a bounce, in the room by the albedo.
TEST(TwoLevelGmres, NeedsFewProductsWithGapsInTheWalls) {
  const BoxRooms boxes = box_rooms(1, 0.7);
  const SenderMatrix matrix(with_gaps(boxes));
  std::vector<double> areas = boxes.areas;
  areas.resize(boxes.size() + 2 * kGaps, 0.05);
  for (const double albedo : {0.95, 0.99}) {
    const Lighting lighting = lit_from_first(areas.size(), albedo);
    const auto problem = make_bounce_problem(matrix, lighting, areas);
    ASSERT_TRUE(problem) << problem.error().message;
    const std::vector<double> exact = dense_solution(matrix, lighting);
    const auto solution = solve_by_gmres(*problem, near_and_far(matrix, areas), {8, 0.0});
    ASSERT_TRUE(solution);
    for (const auto& [first, end] :
         {std::pair(std::size_t{0}, boxes.size()), std::pair(boxes.size(), areas.size())}) {
      double error = 0.0, light = 0.0;
      for (std::size_t i = first; i < end; ++i) {
        error += areas[i] * std::pow(solution->radiosity[i].x - exact[i], 2.0);
        light += areas[i] * std::pow(exact[i] - problem->source[i].x, 2.0);
      }
      EXPECT_LE(std::sqrt(error / light), 1e-3) << albedo << ", clusters from " << first;
    }
  }
}

TEST(TwoLevelGmres, LeavesWhatIsSealedOffDark) {
  const BoxRooms boxes = box_rooms(1, 0.7);
  const auto n = static_cast<std::uint32_t>(boxes.size());
  CsrMatrix both = boxes.matrix;
  both.rows = both.columns = 2 * n;
  for (std::uint32_t row = 0; row < n; ++row) {
    for (auto e = boxes.matrix.row_offsets[row]; e < boxes.matrix.row_offsets[row + 1]; ++e) {
      both.column_indices.push_back(n + boxes.matrix.column_indices[e]);
      both.values.push_back(boxes.matrix.values[e]);
    }
    both.row_offsets.push_back(both.values.size());
  }
  const SenderMatrix matrix(both);
  std::vector<double> areas = boxes.areas;
  areas.insert(areas.end(), boxes.areas.begin(), boxes.areas.end());
  for (const std::uint32_t most : {1u, 3u, 40u}) {
    const Rooms groups = alike_groups(matrix, areas, most);
    EXPECT_LE(groups.count, most);
    std::vector<int> half(groups.count, -1);
    for (std::uint32_t i = 0; i < 2 * n; ++i) {
      if (groups.of_cluster[i] == kNone) continue;
      int& first = half[groups.of_cluster[i]];
      if (first < 0) first = int(i / n);
      EXPECT_EQ(first, int(i / n));
    }
  }
  const auto problem = make_bounce_problem(matrix, lit_from_first(2 * n, 0.9), areas);
  ASSERT_TRUE(problem);
  const auto solution = solve_by_gmres(*problem, near_and_far(matrix, areas), {100, 1e-6});
  ASSERT_TRUE(solution);
  EXPECT_GT(solution->radiosity[n - 1].x, 0.0);
  for (std::uint32_t i = n; i < 2 * n; ++i) EXPECT_EQ(solution->radiosity[i], Rgb(0.0));
}

TEST(TwoLevelGmres, RefusesLevelsOfAnotherScene) {
  const BoxRooms boxes = box_rooms(1, 1.0);
  const SenderMatrix matrix(boxes.matrix);
  const auto problem = make_bounce_problem(matrix, lit_from_first(boxes.size(), 0.5), boxes.areas);
  ASSERT_TRUE(problem);
  const auto solution = solve_by_gmres(*problem, {}, {10, 0.0});
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().code, ErrorCode::usage);
}

TEST(RgbLu, SolvesWhatEigenSolves) {
  constexpr std::size_t kSize = 17;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 0.99 / kSize);
  std::vector<Rgb> matrix(kSize * kSize), right(kSize);
  for (std::size_t k = 0; k < matrix.size(); ++k)
    matrix[k] = (k / kSize == k % kSize ? 1.0 : 0.0) - Rgb(share(random), share(random), share(random));
  for (Rgb& value : right) value = Rgb(share(random), share(random), share(random));
  std::vector<Rgb> found = right;
  RgbLu(matrix, kSize).solve(found);
  for (int channel = 0; channel < 3; ++channel) {
    Eigen::MatrixXd dense(kSize, kSize);
    Eigen::VectorXd b(kSize);
    for (std::size_t k = 0; k < matrix.size(); ++k)
      dense(Eigen::Index(k / kSize), Eigen::Index(k % kSize)) = matrix[k][channel];
    for (std::size_t k = 0; k < kSize; ++k) b(Eigen::Index(k)) = right[k][channel];
    const Eigen::VectorXd expected = dense.partialPivLu().solve(b);
    for (std::size_t k = 0; k < kSize; ++k) EXPECT_NEAR(found[k][channel], expected(Eigen::Index(k)), 1e-13);
  }
}

TEST(RgbLu, TakesNoUnknownWhosePivotIsNotAboveZero) {
  std::vector<Rgb> x{Rgb(1.0), Rgb(2.0)};
  RgbLu({Rgb(0.0), Rgb(0.0), Rgb(0.0), Rgb(0.5)}, 2).solve(x);
  EXPECT_EQ(x[0], Rgb(0.0));
  EXPECT_EQ(x[1], Rgb(4.0));
}

}  // namespace
}  // namespace relume::test
