// SPDX-License-Identifier: MIT
#include "precompute/reciprocal_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace relume::test {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t kSky = 3;  ///< the sender behind three clusters

std::vector<ProjectedRow> targets(std::vector<FormFactorRow>& rows, const std::vector<double>& areas,
                                  const std::vector<double>& rays) {
  std::vector<ProjectedRow> out;
  for (std::size_t i = 0; i < rows.size(); ++i) out.push_back({&rows[i], areas[i], rays[i]});
  return out;
}

double factor(const FormFactorRow& row, std::uint32_t sender) {
  for (std::size_t e = 0; e < row.senders.size(); ++e)
    if (row.senders[e] == sender) return row.values[e];
  return 0.0;
}

// Three clusters of 1, 2 and 3 m2 under a piece of sky. Pair (0, 1) was seen from one side only. Sums of the
// symmetric matrix have to be A_i times those of the rows without the sky: 0.8, 1 and 1.2; with zeros on the
// diagonal they leave no choice: S_01 = (0.8 + 1 - 1.2) / 2 = 0.3, S_02 = 0.5, S_12 = 0.7.
TEST(ReciprocalRows, AreWhatSumsAndSymmetryLeave) {
  std::vector<FormFactorRow> rows{
      {{1, 2, kSky}, {0.5f, 0.3f, 0.2f}}, {{2, kSky}, {0.5f, 0.5f}}, {{0, 1, kSky}, {0.1f, 0.3f, 0.6f}}};
  const auto projected = project_to_reciprocity(targets(rows, {1.0, 2.0, 3.0}, {10.0, 10.0, 10.0}));
  ASSERT_TRUE(projected) << projected.error().message;
  EXPECT_NEAR(factor(rows[0], 1), 0.3, 1e-6);
  EXPECT_NEAR(factor(rows[0], 2), 0.5, 1e-6);
  EXPECT_NEAR(factor(rows[1], 0), 0.3 / 2.0, 1e-6);
  EXPECT_NEAR(factor(rows[1], 2), 0.7 / 2.0, 1e-6);
  EXPECT_NEAR(factor(rows[2], 0), 0.5 / 3.0, 1e-6);
  EXPECT_NEAR(factor(rows[2], 1), 0.7 / 3.0, 1e-6);
  EXPECT_EQ(factor(rows[0], kSky), 0.2f);
  EXPECT_EQ(factor(rows[1], kSky), 0.5f);
  EXPECT_EQ(factor(rows[2], kSky), 0.6f);
  EXPECT_EQ(projected->left, 0.0);
  // S was {0, .5, .3; 0, 0, 1; .3, .9, 0}: differences .5 (01), 0 (02), .1 (12), sums .5, .6, 1.9.
  EXPECT_NEAR(projected->asymmetry, std::sqrt((0.25 + 0.01) / (0.25 + 0.36 + 3.61)), 1e-6);
}

// Of two counts, that of more rays per area weighs more: before any scaling S_01 = (3 x 0.4 + 1 x 0.8) / 4.
TEST(ReciprocalRows, WeighByRays) {
  std::vector<FormFactorRow> rows{{{0, 1}, {0.6f, 0.4f}}, {{0, 1}, {0.8f, 0.2f}}};
  const auto projected = project_to_reciprocity(targets(rows, {1.0, 1.0}, {3.0, 1.0}));
  ASSERT_TRUE(projected) << projected.error().message;
  EXPECT_NEAR(factor(rows[0], 1), factor(rows[1], 0), 1e-6);
  EXPECT_NEAR(factor(rows[0], 0) + factor(rows[0], 1), 1.0, 1e-6);
  EXPECT_NEAR(factor(rows[1], 0) + factor(rows[1], 1), 1.0, 1e-6);
  // d0, d1 of {0.6, 0.5; 0.5, 0.2} with d0 d1 x 0.5 = t: both sums are 1 where (1 - t)^2 / (0.6 x 0.2) = (t /
  // 0.5)^2.
  const double ratio = std::sqrt(0.6 * 0.2) / 0.5;
  EXPECT_NEAR(factor(rows[0], 1), 1.0 / (1.0 + ratio), 1e-6);
}

TEST(ReciprocalRows, AreRefusedWhereNoScalingExists) {
  // They see nothing but each other, and one is three times as large.
  std::vector<FormFactorRow> rows{{{1}, {1.0f}}, {{0}, {1.0f}}};
  const auto projected = project_to_reciprocity(targets(rows, {1.0, 3.0}, {8.0, 8.0}));
  ASSERT_FALSE(projected);
  EXPECT_EQ(projected.error().code, ErrorCode::check_failed);
  EXPECT_THAT(projected.error().message, HasSubstr("no symmetric scaling"));
  EXPECT_EQ(rows[0].values.front(), 1.0f);
}

TEST(ReciprocalRows, AreEmptyOfNothing) {
  std::vector<FormFactorRow> dark(2);
  const auto projected = project_to_reciprocity(targets(dark, {1.0, 1.0}, {8.0, 8.0}));
  ASSERT_TRUE(projected) << projected.error().message;
  EXPECT_TRUE(dark[0].senders.empty());
  EXPECT_TRUE(project_to_reciprocity({}));
}

}  // namespace
}  // namespace relume::test
