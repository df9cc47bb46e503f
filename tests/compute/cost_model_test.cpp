// SPDX-License-Identifier: MIT
#include "compute/cost_model.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace relume::test {
namespace {

TEST(CostModel, FindsTheLineThatFramesLieOn) {
  const std::vector<FrameTime> samples = {{0, 0.001}, {1'000'000, 0.003}, {4'000'000, 0.009}};
  const CostModel model = fit_cost_model(samples);
  EXPECT_NEAR(model.per_frame, 0.001, 1e-12);
  EXPECT_NEAR(model.per_form_factor, 2e-9, 1e-18);
  // (0.005 - 0.001) / 2e-9
  EXPECT_NEAR(static_cast<double>(form_factors_within(model, 0.005)), 2e6, 2.0);
  EXPECT_EQ(form_factors_within(model, 0.0005), 0u);
}

TEST(CostModel, NeitherCoefficientIsNegative) {
  // Larger frames that were faster.
  const CostModel falling = fit_cost_model(std::vector<FrameTime>{{100, 0.02}, {1000, 0.01}});
  EXPECT_EQ(falling.per_form_factor, 0.0);
  EXPECT_GT(falling.per_frame, 0.0);
  // A line that would meet zero time before zero work.
  const CostModel steep = fit_cost_model(std::vector<FrameTime>{{1000, 0.001}, {2000, 0.004}});
  EXPECT_EQ(steep.per_frame, 0.0);
  EXPECT_GT(steep.per_form_factor, 0.0);
}

TEST(CostModel, OneSizeTellsOneCoefficient) {
  const CostModel model = fit_cost_model(std::vector<FrameTime>{{1000, 0.002}, {1000, 0.002}});
  EXPECT_EQ(model.per_frame, 0.0);
  EXPECT_DOUBLE_EQ(model.per_form_factor, 2e-6);
}

TEST(CostModel, WithoutASampleEverythingFits) {
  const CostModel model = fit_cost_model({});
  EXPECT_EQ(form_factors_within(model, 0.001), std::numeric_limits<std::uint64_t>::max());
  // A queue without timestamps gives 0.
  EXPECT_EQ(fit_cost_model(std::vector<FrameTime>{{5, 0.0}}).per_form_factor, 0.0);
}

}  // namespace
}  // namespace relume::test
