// SPDX-License-Identifier: MIT
//
// Every method in every case: the right answer, plain bounces in its place, or a sentence.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <set>

#include "core/methods/certified_solve.h"
#include "stability/lab.h"

namespace relume::test {
namespace {

class EveryMethod : public testing::TestWithParam<std::size_t> {};

/// A row of the README's table goes to the output.
void expect_right_or_said_so(const Case& c) {
  const auto problem = make_bounce_problem(c.matrix, c.lighting, c.areas);
  std::cout << "| " << c.name << " |";
  for (std::size_t m = 0; m < method_names().size(); ++m) {
    SCOPED_TRACE(c.name + ", " + method_names()[m]);
    const Outcome outcome = run_method(c, Method(m));
    std::cout << " " << describe(outcome) << " |";
    EXPECT_NE(outcome.kind, OutcomeKind::wrong) << outcome.products << " products";
    if (c.exact.empty()) {
      EXPECT_EQ(outcome.kind, OutcomeKind::refused);
      EXPECT_GE(c.spectral_radius, 1.0);
      EXPECT_NE(outcome.sentence.find("at each bounce"), std::string::npos) << outcome.sentence;
    } else if (outcome.kind == OutcomeKind::refused) {
      // Only where the method cannot be used, never for lack of a bound.
      EXPECT_TRUE(problem) << outcome.sentence;
      EXPECT_EQ(Method(m), Method::conjugate_gradients) << outcome.sentence;
    }
  }
  std::cout << "\n";
}

void expect_a_default_that_is_right(const Case& c) {
  const auto problem = make_bounce_problem(c.matrix, c.lighting, c.areas);
  ASSERT_TRUE(problem) << problem.error().message;
  const MethodChoice choice = choose_method(*problem, kLabRule);
  EXPECT_FALSE(choice.reason.empty());
  const Outcome outcome = run_method(c, choice.method);
  EXPECT_TRUE(outcome.kind == OutcomeKind::right || outcome.kind == OutcomeKind::fell_back)
      << c.name << ": " << describe(outcome) << " by " << method_names()[std::size_t(choice.method)];
}

TEST_P(EveryMethod, IsRightOrSaysSoAndTheDefaultReachesTheTolerance) {
  const Case c = all_cases()[GetParam()].make();
  expect_right_or_said_so(c);
  if (!c.exact.empty()) expect_a_default_that_is_right(c);
}

std::string case_name(const testing::TestParamInfo<std::size_t>& info) {
  std::string name = all_cases()[info.param].name;
  for (char& letter : name) {
    if (!std::isalnum(static_cast<unsigned char>(letter))) letter = '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Lab, EveryMethod, testing::Range(std::size_t{0}, all_cases().size()), case_name);

TEST(OverRelaxation, SurvivesMoreThanTheBest) {
  const Case c = box_case("two rooms, 0.99", 2, 1.0, 0.99);
  const auto problem = make_bounce_problem(c.matrix, c.lighting, c.areas);
  ASSERT_TRUE(problem);
  double best = 1.0;
  std::uint32_t fewest = kLabRule.max_bounces + 1;
  for (double omega = 1.0; omega < 2.0; omega += 0.05) {
    const auto solution = solve_by_over_relaxation(*problem, Rgb(omega), kLabRule);
    ASSERT_NE(judge(c, solution, kLabRule).kind, OutcomeKind::wrong) << omega;
    if (solution->fallback.empty() && solution->bounces < fewest) best = omega, fewest = solution->bounces;
  }
  EXPECT_GT(best, 1.3);
  const auto above = solve_by_over_relaxation(*problem, Rgb(std::min(1.05 * best, 1.999)), kLabRule);
  EXPECT_NE(judge(c, above, kLabRule).kind, OutcomeKind::wrong);
}

TEST(OverRelaxation, GivesWayWhereItDiverges) {
  // Sweeps diverge for any factor above 2 (W. Kahan, 1958).
  const Case c = box_case("two rooms, 0.9", 2, 1.0, 0.9);
  const auto problem = make_bounce_problem(c.matrix, c.lighting, c.areas);
  ASSERT_TRUE(problem);
  const StopRule rule{1000, 1e-6};
  const auto solution = solve_by_over_relaxation(*problem, Rgb(2.2), rule);
  EXPECT_EQ(judge(c, solution, rule).kind, OutcomeKind::fell_back);
}

TEST(Chebyshev, GivesWayWhenItsIntervalIsWrong) {
  // The spectrum reaches to 0.95; polynomials for [-0.2, 0.2] about 0.6 grow on what lies below and above.
  const Case c = box_case("two rooms, 0.95", 2, 1.0, 0.95);
  const auto problem = make_bounce_problem(c.matrix, c.lighting, c.areas);
  ASSERT_TRUE(problem);
  const StopRule rule{1000, 1e-6};
  const auto solution = solve_by_chebyshev(*problem, {Rgb(0.8), Rgb(0.99)}, rule);
  EXPECT_EQ(judge(c, solution, rule).kind, OutcomeKind::fell_back) << describe(judge(c, solution, rule));
  const auto narrow = solve_by_chebyshev(*problem, {Rgb(-0.1), Rgb(0.1)}, rule);
  EXPECT_NE(judge(c, narrow, rule).kind, OutcomeKind::wrong);
}

TEST(ConjugateGradients, ForcedOnRowsOfRaysNeverGiveAWrongNumber) {
  for (const CaseMaker& maker : all_cases()) {
    if (maker.name.find("rays") == std::string::npos && maker.name.find("8-bit rows,") == std::string::npos)
      continue;
    const Case c = maker.make();
    const auto problem = make_bounce_problem(c.matrix, c.lighting, c.areas);
    ASSERT_TRUE(problem);
    const StopRule rule{3000, 1e-6};
    const Outcome outcome = judge(c, solve_by_conjugate_gradients(*problem, rule, {}, 10.0), rule);
    EXPECT_TRUE(outcome.kind == OutcomeKind::right || outcome.kind == OutcomeKind::fell_back) << c.name;
  }
}

TEST(ConjugateGradients, AreRefusedByRowsOfRays) {
  for (const CaseMaker& maker : all_cases()) {
    if (maker.name.find("rays") == std::string::npos && maker.name.find("clustered") == std::string::npos)
      continue;
    const Outcome outcome = run_method(maker.make(), Method::conjugate_gradients);
    EXPECT_EQ(outcome.kind, OutcomeKind::refused);
    EXPECT_NE(outcome.sentence.find("symmetric"), std::string::npos) << outcome.sentence;
  }
}

TEST(TwoLevels, NeedFewProductsAtAnyAlbedo) {
  // Plain bounces take ln 1e-3 / ln 0.99 = 687 at 0.99, and 135 at 0.95 (performance of the law of geometric
  // series).
  for (const std::uint32_t rooms : {1u, 2u, 8u}) {
    for (const double albedo : {0.5, 0.8, 0.95, 0.99}) {
      const Case c = box_case("rooms", rooms, 1.0, albedo);
      const auto problem = make_bounce_problem(c.matrix, c.lighting, c.areas);
      ASSERT_TRUE(problem);
      EXPECT_EQ(c.rooms.count, rooms);
      const SceneLevels levels{c.rooms, near_and_far(c.matrix, c.areas)};
      for (const Method method : {Method::two_level, Method::two_level_gmres}) {
        const auto solution = solve_by(method, *problem, levels, {10, 0.0});
        ASSERT_TRUE(solution);
        double error = 0.0, light = 0.0;
        for (std::size_t i = 0; i < c.areas.size(); ++i) {
          EXPECT_GE(solution->radiosity[i].x, 0.0);
          error += c.areas[i] * std::pow(solution->radiosity[i].x - c.exact[i], 2.0);
          light += c.areas[i] * std::pow(c.exact[i] - problem->source[i].x, 2.0);
        }
        EXPECT_LE(std::sqrt(error / light), 1e-3) << rooms << " rooms, " << albedo;
      }
    }
  }
}

TEST(Bracket, SaysWhenItIsUndecided) {
  // 1 feeds 2 and each feeds itself: lambda = 0.9999, but the rows of a Jordan block stay above it as 1 / k
  // after k products.
  CsrMatrix matrix;
  matrix.rows = matrix.columns = 2;
  matrix.row_offsets = {0, 2, 3};
  matrix.column_indices = {0, 1, 1};
  matrix.values = {1.0, 1.0, 1.0};
  Lighting lighting;
  lighting.albedo.assign(2, Rgb(0.9999));
  lighting.exitance.assign(2, Rgb(1.0));
  lighting.direct.assign(2, Rgb(0.0));
  const SenderMatrix rows(matrix);
  const auto problem = make_bounce_problem(rows, lighting, {1.0, 1.0});
  ASSERT_FALSE(problem);
  EXPECT_NE(problem.error().message.find("may not converge: in channel 0, after 256 products"),
            std::string::npos)
      << problem.error().message;
}

TEST(Method, NamesAreUnique) {
  std::set<std::string> names(method_names().begin(), method_names().end());
  EXPECT_EQ(names.size(), std::size_t(Method::two_level_gmres) + 1);
}

/// The largest number of so many bits of mantissa that is not larger.
double truncated(double value, int bits) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(std::floor(std::ldexp(mantissa, bits)), exponent - bits);
}

/// Bounces that store radiosity in a short format stop short of the answer; the certificate says by how much
/// at most.
TEST(Certificate, BoundsWhatShortFeedbackLoses) {
  const Case c = box_case("two rooms, 0.95", 2, 1.0, 0.95);
  const auto problem = make_bounce_problem(c.matrix, c.lighting, c.areas);
  ASSERT_TRUE(problem);
  double lost_by_11_bits = 0.0;
  for (const int bits : {11, 7}) {  // half precision, and the red and green of R11G11B10, truncated
    std::vector<Rgb> x = problem->source;
    for (int k = 0; k < 300; ++k) {
      x = bounce(c.matrix, c.lighting, x);
      for (Rgb& value : x)
        value = Rgb(truncated(value.x, bits), truncated(value.y, bits), truncated(value.z, bits));
    }
    const StopRule rule{1, 1e-6};
    const BounceObserver observer;
    CertifiedSolve solve(*problem, rule, observer);
    solve.bounce(x);
    const auto solution = std::move(solve).finish();
    EXPECT_EQ(judge(c, solution, rule).kind, OutcomeKind::bounded);
    double error = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      error = std::max(error, std::abs(solution->radiosity[i].x - c.exact[i]));
      largest = std::max(largest, c.exact[i]);
    }
    // Each bounce loses up to 2^(1 - bits) of all light, and 1 / (1 - 0.95) of them are under way.
    EXPECT_LE(error, 1.5 * std::ldexp(2.0, -bits) / 0.05 * largest);
    EXPECT_GT(error, 4.0 * lost_by_11_bits);
    if (bits == 11) lost_by_11_bits = error;
  }
}

}  // namespace
}  // namespace relume::test
