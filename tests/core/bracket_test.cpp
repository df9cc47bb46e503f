// SPDX-License-Identifier: MIT
#include "core/bracket.h"

#include <gtest/gtest.h>

#include <random>

#include "core/value_slack.h"

namespace relume {
namespace {

/// Three clusters: the first receives 0.5 from a node of the other two, which receive nothing.
ReferenceMatrices one_row_over_a_node(double form_factor) {
  const CsrMatrix rows{3, 4, {0, 1, 1, 1}, {3}, {form_factor}};
  const CsrMatrix nodes{1, 3, {0, 2}, {1, 2}, {0.75, 0.25}};
  const CsrMatrix gathered{1, 4, {0, 1}, {3}, {form_factor}};
  return {SenderMatrix(rows, nodes), SenderMatrix(gathered, nodes)};
}

Lighting emitters(double first, double second) {
  Lighting lighting;
  lighting.albedo.assign(3, Rgb(0.5));
  lighting.exitance = {Rgb(1.0), Rgb(first), Rgb(second)};
  lighting.direct.assign(3, Rgb(0.0));
  return lighting;
}

TEST(Bracket, OfANodeIsTheLeastAndTheMostOfItsLeaves) {
  const ReferenceMatrices matrices = one_row_over_a_node(0.5), exact = one_row_over_a_node(0.0);
  const auto result = bracket_solution(matrices, exact, emitters(2.0, 8.0), {Rgb(1.0), Rgb(2.0), Rgb(8.0)});
  ASSERT_TRUE(result) << result.error().message;
  // B_0 = 1 + 0.5 (0.5 x 2 to 8); the gather row sees the node as well.
  EXPECT_NEAR(result->radiosity.low[0].x, 1.5, 1e-4);
  EXPECT_NEAR(result->radiosity.high[0].x, 3.0, 1e-4);
  EXPECT_NEAR(result->irradiance.low[0].x, 1.0, 1e-4);
  EXPECT_NEAR(result->irradiance.high[0].x, 4.0, 1e-4);
  EXPECT_NEAR(relative_widths(result->irradiance, {Rgb(2.0)})[0], 1.5, 1e-3);
}

TEST(Bracket, OfEqualLeavesHasNoWidthWhateverTheSlack) {
  const ReferenceMatrices matrices = one_row_over_a_node(0.5), slack = one_row_over_a_node(0.1);
  const auto result = bracket_solution(matrices, slack, emitters(4.0, 4.0), {Rgb(1.0), Rgb(4.0), Rgb(4.0)});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_NEAR(result->radiosity.low[0].x, 2.0, 1e-4);
  EXPECT_NEAR(result->radiosity.high[0].x, 2.0, 1e-4);
}

/// Two clusters that both receive from a node of the two.
ReferenceMatrices furnace(double form_factor) {
  const CsrMatrix rows{2, 3, {0, 1, 2}, {2, 2}, {form_factor, form_factor}};
  const CsrMatrix nodes{1, 2, {0, 2}, {0, 1}, {0.5, 0.5}};
  return {SenderMatrix(rows, nodes), SenderMatrix(rows, nodes)};
}

TEST(Bracket, OfAFurnaceIsAPointAndOfOneTooHotIsRefused) {
  Lighting lighting;
  lighting.albedo.assign(2, Rgb(0.8));
  lighting.exitance.assign(2, Rgb(1.0));
  lighting.direct.assign(2, Rgb(0.0));
  const auto solved = bracket_solution(furnace(1.0), furnace(0.1), lighting, std::vector<Rgb>(2, Rgb(1.0)));
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_NEAR(solved->radiosity.low[0].x, 5.0, 1e-4);
  EXPECT_NEAR(solved->radiosity.high[1].z, 5.0, 1e-4);
  // 0.8 (1 + 2 x 0.2) = 1.12: what the slack leaves open could grow for ever.
  const auto refused = bracket_solution(furnace(1.0), furnace(0.2), lighting, std::vector<Rgb>(2, Rgb(1.0)));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::check_failed);
  EXPECT_NE(refused.error().message.find("1.12"), std::string::npos) << refused.error().message;
}

TEST(Bracket, CanBeCancelled) {
  const ReferenceMatrices matrices = one_row_over_a_node(0.5), exact = one_row_over_a_node(0.0);
  const auto result = bracket_solution(matrices, exact, emitters(2.0, 8.0), std::vector<Rgb>(3, Rgb(1.0)),
                                       [] { return false; });
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::cancelled);
}

class ValueSlack : public testing::TestWithParam<ValueCodec> {};

TEST_P(ValueSlack, IsNeverLessThanWhatTheCodeLost) {
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
    const CsrMatrix stored = decode(matrix), slack = decode_slack(matrix);
    ASSERT_EQ(stored.column_indices, slack.column_indices);
    ASSERT_EQ(stored.values.size(), count) << "what is not zero must not become it";
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_LE(std::abs(stored.values[i] - values[i]), slack.values[i]) << i << " of " << count;
  }
}

TEST_P(ValueSlack, IsSmall) {
  BlockMatrixBuilder builder(100, GetParam());
  std::vector<std::uint16_t> columns(100);
  for (std::size_t i = 0; i < 100; ++i) columns[i] = static_cast<std::uint16_t>(i);
  builder.append_row(columns, std::vector<double>(100, 0.009));
  double sum = 0.0;
  for (const double value : decode_slack(std::move(builder).finish()).values) sum += value;
  EXPECT_LT(sum, GetParam() == ValueCodec::sqrt8 ? 0.02 : 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Codecs, ValueSlack,
                         testing::Values(ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8));

}  // namespace
}  // namespace relume
