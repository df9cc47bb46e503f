// SPDX-License-Identifier: MIT
#include "core/bracket.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/halvings.h"
#include "core/value_slack.h"

namespace relume {
namespace {

LooseRows loose(const CsrMatrix& rows, const CsrMatrix& nodes, double slack) {
  LooseRows matrix;
  matrix.rows = rows, matrix.nodes = nodes, matrix.told_nodes = nodes.rows;
  matrix.slack.assign(rows.values.size(), slack), matrix.running.assign(rows.values.size(), 1.0);
  matrix.first_halving.assign(rows.rows, kUntold);
  return matrix;
}

/// Three clusters: the first receives 0.5 from a node of the other two, which receive nothing.
LooseMatrices one_row_over_a_node(double slack) {
  const CsrMatrix rows{3, 4, {0, 1, 1, 1}, {3}, {0.5}};
  const CsrMatrix nodes{1, 3, {0, 2}, {1, 2}, {0.75, 0.25}};
  const CsrMatrix gathered{1, 4, {0, 1}, {3}, {0.5}};
  return {loose(rows, nodes, slack), loose(gathered, nodes, slack)};
}

Lighting emitters(double first, double second) {
  Lighting lighting;
  lighting.albedo.assign(3, Rgb(0.5));
  lighting.exitance = {Rgb(1.0), Rgb(first), Rgb(second)};
  lighting.direct.assign(3, Rgb(0.0));
  return lighting;
}

TEST(Bracket, OfANodeIsTheLeastAndTheMostOfItsLeaves) {
  const auto result =
      bracket_solution(one_row_over_a_node(0.0), emitters(2.0, 8.0), {Rgb(1.0), Rgb(2.0), Rgb(8.0)});
  ASSERT_TRUE(result) << result.error().message;
  // B_0 = 1 + 0.5 (0.5 x 2 to 8); the gather row sees the node as well.
  EXPECT_NEAR(result->radiosity.low[0].x, 1.5, 1e-4);
  EXPECT_NEAR(result->radiosity.high[0].x, 3.0, 1e-4);
  EXPECT_NEAR(result->irradiance.low[0].x, 1.0, 1e-4);
  EXPECT_NEAR(result->irradiance.high[0].x, 4.0, 1e-4);
  EXPECT_NEAR(relative_widths(result->irradiance, {Rgb(2.0)})[0], 1.5, 1e-3);
}

// The gather row's halving says that the second leaf gets at least as much as the first, or all, or nothing.
TEST(Bracket, IsNarrowerWhereHalvingsTellWhatLeavesGet) {
  LooseMatrices matrices = one_row_over_a_node(0.0);
  matrices.gather.first_halving = {0};
  const auto gathered = [&](Halving halving) {
    matrices.gather.halvings = {std::uint8_t(halving)};
    const auto result = bracket_solution(matrices, emitters(2.0, 8.0), {Rgb(1.0), Rgb(2.0), Rgb(8.0)});
    return std::pair(result.value().irradiance.low[0].x, result.value().irradiance.high[0].x);
  };
  EXPECT_NEAR(gathered(Halving::second_least).first, 0.5 * 5.0, 1e-4);
  EXPECT_NEAR(gathered(Halving::second_least).second, 0.5 * 8.0, 1e-4);
  EXPECT_NEAR(gathered(Halving::first_more).first, 0.5 * 2.0, 1e-4);
  EXPECT_NEAR(gathered(Halving::first_more).second, 0.5 * 5.0, 1e-4);
  EXPECT_NEAR(gathered(Halving::first).second, 0.5 * 2.0, 1e-4);
  EXPECT_NEAR(gathered(Halving::second).first, 0.5 * 8.0, 1e-4);
}

// Two entries of 0.25, of which each may be off by 0.1 and their sum by 0.06 after the first, by 0 in the
// end: a leaf of 2 and one of 8 are worth 2.5 +- 0.06 x 6.
TEST(Bracket, TakesTheSmallerOfWhatCodesMayHide) {
  const CsrMatrix rows{2, 2, {0, 0, 0}, {}, {}}, nodes{0, 2, {0}, {}, {}};
  const CsrMatrix gathered{1, 2, {0, 2}, {0, 1}, {0.25, 0.25}};
  LooseMatrices matrices{loose(rows, nodes, 0.0), loose(gathered, nodes, 0.1)};
  matrices.gather.running = {0.06, 0.0};
  Lighting lighting;
  lighting.albedo.assign(2, Rgb(0.5)), lighting.direct.assign(2, Rgb(0.0));
  lighting.exitance = {Rgb(2.0), Rgb(8.0)};
  const auto by_parts = bracket_solution(matrices, lighting, lighting.exitance);
  ASSERT_TRUE(by_parts) << by_parts.error().message;
  EXPECT_NEAR(by_parts->irradiance.low[0].x, 2.5 - 0.36, 1e-6);
  EXPECT_NEAR(by_parts->irradiance.high[0].x, 2.5 + 0.36, 1e-6);
  matrices.gather.running = {1.0, 1.0};  // each then: 0.1 x 3 of both
  const auto each = bracket_solution(matrices, lighting, lighting.exitance);
  EXPECT_NEAR(each.value().irradiance.high[0].x, 2.5 + 0.6, 1e-6);
}

TEST(Bracket, OfEqualLeavesHasNoWidthWhateverTheSlack) {
  const auto result =
      bracket_solution(one_row_over_a_node(0.1), emitters(4.0, 4.0), {Rgb(1.0), Rgb(4.0), Rgb(4.0)});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_NEAR(result->radiosity.low[0].x, 2.0, 1e-4);
  EXPECT_NEAR(result->radiosity.high[0].x, 2.0, 1e-4);
}

/// Two clusters that both receive from a node of the two.
LooseMatrices furnace(double form_factor, double slack) {
  const CsrMatrix rows{2, 3, {0, 1, 2}, {2, 2}, {form_factor, form_factor}};
  const CsrMatrix nodes{1, 2, {0, 2}, {0, 1}, {0.5, 0.5}};
  return {loose(rows, nodes, slack), loose(rows, nodes, slack)};
}

TEST(Bracket, OfAFurnaceIsAPointAndOfOneTooHotIsRefused) {
  Lighting lighting;
  lighting.albedo.assign(2, Rgb(0.8));
  lighting.exitance.assign(2, Rgb(1.0));
  lighting.direct.assign(2, Rgb(0.0));
  const auto solved = bracket_solution(furnace(1.0, 0.2), lighting, std::vector<Rgb>(2, Rgb(4.999)));
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_NEAR(solved->radiosity.low[0].x, 5.0, 2e-3);
  EXPECT_NEAR(solved->radiosity.high[1].z, 5.0, 2e-3);
  EXPECT_LE(solved->radiosity.low[0].x, 5.0);
  EXPECT_GE(solved->radiosity.high[0].x, 5.0);
  const auto refused = bracket_solution(furnace(1.3, 0.0), lighting, std::vector<Rgb>(2, Rgb(1.0)));
  ASSERT_FALSE(refused);  // 0.8 x 1.3
  EXPECT_EQ(refused.error().code, ErrorCode::check_failed);
  EXPECT_NE(refused.error().message.find("1.04"), std::string::npos) << refused.error().message;
}

// A cluster sees itself and a black one by half; if what it sees of both could be off by more than there is,
// its most would grow by 0.9 (0.5 + 1.5) at each bounce.
TEST(Bracket, IsRefusedWhereItWouldGrowWithoutEnd) {
  const CsrMatrix rows{2, 2, {0, 2, 2}, {0, 1}, {0.5, 0.5}}, nodes{0, 2, {0}, {}, {}};
  Lighting lighting;
  lighting.albedo.assign(2, Rgb(0.9)), lighting.direct.assign(2, Rgb(0.0));
  lighting.exitance = {Rgb(1.0), Rgb(0.0)};
  const LooseMatrices matrices{loose(rows, nodes, 2.0), loose(rows, nodes, 2.0)};
  const auto refused = bracket_solution(matrices, lighting, {Rgb(1.818), Rgb(0.0)});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::check_failed);
  EXPECT_NE(refused.error().message.find("without end"), std::string::npos) << refused.error().message;
}

TEST(Bracket, CanBeCancelled) {
  const auto result = bracket_solution(one_row_over_a_node(0.0), emitters(2.0, 8.0),
                                       std::vector<Rgb>(3, Rgb(1.0)), [] { return false; });
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::cancelled);
}

class ValueSlackTest : public testing::TestWithParam<ValueCodec> {};

/// Codes are the stored values in units of the largest, which is encoded exactly.
void expect_sums_within(const CsrMatrix& stored, const std::vector<double>& values, const ValueSlack& slack) {
  const double unit = *std::max_element(values.begin(), values.end()) /
                      *std::max_element(stored.values.begin(), stored.values.end());
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += unit * stored.values[i] - values[i];
    ASSERT_LE(std::abs(sum), slack.running[i]) << i << " of " << values.size();
  }
}

TEST_P(ValueSlackTest, IsNeverLessThanWhatTheCodeLost) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-7.0, 0.0);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t count = 1 + trial * 3;
    std::vector<double> values(count);
    double sum = 0.0;
    for (double& value : values) sum += value = std::pow(10.0, exponent(random));
    std::vector<std::uint16_t> columns(count);
    for (std::size_t i = 0; i < count; ++i) {
      columns[i] = static_cast<std::uint16_t>(i);
      values[i] /= 1.25 * sum;
    }
    BlockMatrixBuilder builder(static_cast<std::uint32_t>(count), GetParam());
    builder.append_row(columns, values);
    const BlockMatrix matrix = std::move(builder).finish();
    const CsrMatrix stored = decode(matrix);
    const ValueSlack slack = decode_slack(matrix);
    ASSERT_EQ(stored.column_indices, slack.each.column_indices);
    ASSERT_EQ(stored.values.size(), count) << "what is not zero must not become it";
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_LE(std::abs(stored.values[i] - values[i]), slack.each.values[i]) << i << " of " << count;
    expect_sums_within(stored, values, slack);
  }
}

TEST_P(ValueSlackTest, IsSmall) {
  BlockMatrixBuilder builder(100, GetParam());
  std::vector<std::uint16_t> columns(100);
  for (std::size_t i = 0; i < 100; ++i) columns[i] = static_cast<std::uint16_t>(i);
  builder.append_row(columns, std::vector<double>(100, 0.009));
  double sum = 0.0;
  for (const double value : decode_slack(std::move(builder).finish()).each.values) sum += value;
  EXPECT_LT(sum, GetParam() == ValueCodec::sqrt8 ? 0.02 : 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Codecs, ValueSlackTest,
                         testing::Values(ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8));

}  // namespace
}  // namespace relume
