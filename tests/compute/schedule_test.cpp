// SPDX-License-Identifier: MIT
#include "compute/schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "compute/test_models.h"

namespace relume::test {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

constexpr double kLargest = 1e6;

/// Systems of two bounce and one gather dispatch each, of `cost`; `shares[t][s]`: what t sees of s.
std::vector<SystemTraits> traits_of(const DenseMatrix& shares, std::uint64_t cost = 100) {
  std::vector<SystemTraits> all;
  for (const std::vector<double>& row : shares) {
    SystemTraits traits;
    traits.loaded = true;
    const auto set = [&](StepKernel kernel, std::vector<std::uint64_t> costs) {
      traits.costs[static_cast<std::size_t>(kernel)] = std::move(costs);
    };
    set(StepKernel::start, {1});
    set(StepKernel::import_radiosity, {10});
    set(StepKernel::bounce, {cost, cost});
    set(StepKernel::nodes, {5});
    set(StepKernel::residual, {1});
    set(StepKernel::gather, {cost});
    for (std::uint32_t s = 0; s < row.size(); ++s) {
      if (row[s] > 0.0) traits.bounce.shares.push_back({s, row[s]});
      if (s < shares.size()) traits.bounce.total += row[s];
    }
    traits.gather = traits.bounce;
    all.push_back(traits);
  }
  return all;
}

/// All systems active, started, and with nothing left to do.
Schedule settled(const std::vector<SystemTraits>& traits) {
  Schedule schedule = make_schedule(traits.size(), kLargest);
  for (std::uint32_t s = 0; s < traits.size(); ++s) {
    activate(traits, schedule, s);
    schedule.systems[s].started = true;
  }
  for (SystemProgress& system : schedule.systems) system.error = system.output_error = 0.0;
  return schedule;
}

std::vector<std::uint32_t> bounced(const FramePlan& plan) {
  std::vector<std::uint32_t> systems;
  for (const FrameStep& step : plan.steps) {
    if (step.kind == FrameStep::Kind::flip) systems.push_back(step.system);
  }
  return systems;
}

std::vector<std::uint32_t> published(const FramePlan& plan) {
  std::vector<std::uint32_t> systems;
  for (const FrameStep& step : plan.steps) {
    if (step.kind == FrameStep::Kind::publish) systems.push_back(step.system);
  }
  return systems;
}

TEST(Schedule, WithoutAStepEverySystemBouncesInEveryFrame) {
  const auto traits = traits_of({{0.2, 0.1}, {0.1, 0.2}});
  const Schedule schedule = settled(traits);
  const FramePlan plan = plan_frame(traits, schedule, {.bounces = 2});
  EXPECT_THAT(bounced(plan), ElementsAre(0u, 1u, 0u, 1u));
  EXPECT_THAT(published(plan), ElementsAre(0u, 1u));
  EXPECT_TRUE(plan.pass_complete);
  // Per system: two bounces of 10 + 200 + 5, an import and a gather.
  EXPECT_EQ(plan.cost, 2u * (2u * 215u + 110u));
}

// 0 -> 1 -> 2: a change of 8 in system 0 arrives as 4 in 1 and as 1 in 2.
TEST(Schedule, AChangeSpreadsAsFarAsItIsSeen) {
  const auto traits = traits_of({{0.0, 0.0, 0.0}, {0.5, 0.0, 0.0}, {0.0, 0.25, 0.0}});
  Schedule schedule = settled(traits);
  note_change(traits, schedule, 0, 8.0);
  EXPECT_THAT(radiosity_errors(schedule), ElementsAre(8.0, 4.0, 1.0));
  const FrameWishes wishes{.max_form_factors = 330, .display_step = 0.5};
  std::vector<std::vector<std::uint32_t>> frames;
  for (int i = 0; i < 4; ++i) {
    const FramePlan plan = plan_frame(traits, schedule, wishes);
    EXPECT_LE(plan.cost, 330u);
    frames.push_back(bounced(plan));
    schedule = plan.next;
  }
  EXPECT_THAT(frames[0], ElementsAre(0u));
  EXPECT_THAT(frames[1], ElementsAre(1u));
  EXPECT_THAT(frames[2], ElementsAre(2u));
  EXPECT_TRUE(frames[3].empty());
  EXPECT_EQ(plan_frame(traits, schedule, wishes).output_error, 0.0);
}

TEST(Schedule, TheSystemThatChangedMostGoesFirst) {
  const auto traits = traits_of({{0.1, 0.0, 0.0}, {0.0, 0.1, 0.0}, {0.0, 0.0, 0.1}});
  Schedule schedule = settled(traits);
  note_change(traits, schedule, 0, 2.0);
  note_change(traits, schedule, 1, 7.0);
  note_change(traits, schedule, 2, 5.0);
  const FramePlan plan = plan_frame(traits, schedule, {.max_form_factors = 700, .display_step = 1.0});
  EXPECT_THAT(bounced(plan), ElementsAre(1u, 2u));
}

TEST(Schedule, WhatIsBelowTheStepIsLeftOutUntilItAddsUp) {
  // What is left to do after a change of d is d / (1 - 0.5) at most; half of the step is for that.
  const auto traits = traits_of({{0.5}});
  Schedule schedule = settled(traits);
  const FrameWishes wishes{.display_step = 4.0};
  int left_out = 0;
  for (FramePlan plan; bounced(plan).empty(); schedule = plan.next, ++left_out) {
    note_change(traits, schedule, 0, 0.3);
    plan = plan_frame(traits, schedule, wishes);
    if (!bounced(plan).empty()) break;
    EXPECT_TRUE(plan.steps.empty());
    EXPECT_LE(plan.output_error, 4.0);
    EXPECT_DOUBLE_EQ(plan.skipped, plan.output_error);
    // The gather sees half of what the radiosity is off by, 2 x the change.
    EXPECT_NEAR(plan.skipped, 0.5 * 2.0 * 0.3 * (left_out + 1), 1e-4);
  }
  // 0.3 + 0.3 + 0.3 is the last below 1.
  EXPECT_EQ(left_out, 3);
}

TEST(Schedule, NothingLeftToDoMeansWithinTheStep) {
  const auto traits = traits_of({{0.3, 0.4}, {0.5, 0.1}});
  Schedule schedule = settled(traits);
  note_change(traits, schedule, 0, 1000.0);
  const FrameWishes wishes{.max_form_factors = 150, .display_step = 0.01};
  FramePlan plan;
  int frames = 0;
  do {
    plan = plan_frame(traits, schedule, wishes);
    schedule = plan.next;
    ASSERT_LT(++frames, 1000);
  } while (!plan.steps.empty());
  EXPECT_LE(plan.output_error, 0.01);
  EXPECT_GT(frames, 20);
}

TEST(Schedule, RowsBoundWhatTheSharesOfSystemsDoNot) {
  // Some cluster of 0 sees 0.6 of system 0, another 0.6 of system 1; no row sums to more than 0.6.
  auto traits = traits_of({{0.6, 0.6}, {0.6, 0.6}});
  for (SystemTraits& system : traits) system.bounce.total = 0.6;
  Schedule schedule = settled(traits);
  note_change(traits, schedule, 0, 4.0);
  // 4 / (1 - 0.6); system 1 sees 0.6 of that.
  EXPECT_NEAR(radiosity_errors(schedule)[0], 10.0, 1e-9);
  EXPECT_NEAR(radiosity_errors(schedule)[1], 6.0, 1e-9);
}

TEST(Schedule, WhatDoesNotContractIsOffByNoMoreThanAnythingShines) {
  const auto traits = traits_of({{1.0}});
  Schedule schedule = settled(traits);
  note_change(traits, schedule, 0, 4.0);
  EXPECT_EQ(radiosity_errors(schedule)[0], kLargest);
  // It is never done.
  EXPECT_THAT(bounced(plan_frame(traits, schedule, {.display_step = 1.0})), ElementsAre(0u));
}

TEST(Schedule, TheSkyChangesThoseThatSeeIt) {
  const auto traits = traits_of({{0.1, 0.0, 0.5}, {0.0, 0.1, 0.0}});
  Schedule schedule = settled(traits);
  note_change(traits, schedule, 2, 10.0);
  EXPECT_THAT(radiosity_errors(schedule), ElementsAre(DoubleNear(5.0 / 0.9, 1e-3), DoubleNear(0.0, 1e-9)));
}

TEST(Schedule, APlanThatIsDroppedIsMadeAgain) {
  const auto traits = traits_of({{0.2, 0.1}, {0.1, 0.2}});
  Schedule schedule = settled(traits);
  note_change(traits, schedule, 0, 3.0);
  const FrameWishes wishes{.max_form_factors = 120, .display_step = 0.1};
  const FramePlan once = plan_frame(traits, schedule, wishes);
  const FramePlan again = plan_frame(traits, schedule, wishes);
  ASSERT_EQ(once.steps.size(), again.steps.size());
  for (std::size_t i = 0; i < once.steps.size(); ++i) {
    EXPECT_EQ(once.steps[i].system, again.steps[i].system);
    EXPECT_EQ(once.steps[i].dispatch, again.steps[i].dispatch);
  }
}

TEST(Schedule, ASystemThatLeavesGivesItsPassUp) {
  const auto traits = traits_of({{0.2, 0.1}, {0.1, 0.2}});
  Schedule schedule = settled(traits);
  note_change(traits, schedule, 0, 3.0);
  note_change(traits, schedule, 1, 2.0);
  const double before = schedule.systems[0].error;
  const FramePlan part = plan_together(traits, schedule, {.bounces = 1, .max_form_factors = 250});
  ASSERT_FALSE(part.pass_complete);
  schedule = part.next;
  EXPECT_EQ(schedule.systems[0].error, before);
  deactivate(traits, schedule, 1);
  EXPECT_EQ(schedule.pass.stage, PassStage::done);
  EXPECT_EQ(schedule.systems[0].half, 0u);
  EXPECT_THAT(bounced(plan_frame(traits, schedule, {})), ElementsAre(0u));
}

// q = 1/2 and E = 16 everywhere: four bounces leave 1, of which gathers see one half.
TEST(Schedule, AToleranceTakesAsManyBouncesAsItNeeds) {
  const auto traits = traits_of({{0.25, 0.25}, {0.5}});
  Schedule schedule = settled(traits);
  for (SystemProgress& system : schedule.systems) system.error = system.output_error = 16.0;
  const PassWishes wishes{.bounces = 100, .tolerance = 1.0, .gather = true};
  const FramePlan plan = plan_together(traits, schedule, wishes);
  EXPECT_EQ(bounced(plan).size(), 2u * 3u);
  EXPECT_DOUBLE_EQ(plan.output_error, 1.0);
  EXPECT_TRUE(plan_together(traits, plan.next, wishes).steps.empty());
  const FramePlan radiosity = plan_together(traits, schedule, {.bounces = 100, .tolerance = 1.0});
  EXPECT_EQ(bounced(radiosity).size(), 2u * 4u);
  EXPECT_DOUBLE_EQ(radiosity.radiosity_error, 1.0);
  const FramePlan few = plan_together(traits, schedule, {.bounces = 2, .tolerance = 1.0, .gather = true});
  EXPECT_EQ(bounced(few).size(), 2u * 2u);
  EXPECT_DOUBLE_EQ(few.output_error, 2.0);
}

// What a frame with a limit left half done is finished first, by one plan as by many.
TEST(Schedule, AToleranceIsReachedInOnePlanOrInSlices) {
  const auto traits = traits_of({{0.25, 0.25}, {0.5}});
  Schedule schedule = settled(traits);
  note_change(traits, schedule, 0, 16.0);
  schedule = plan_frame(traits, schedule, {.max_form_factors = 150}).next;
  ASSERT_NE(schedule.pass.stage, PassStage::done);
  PassWishes wishes{.bounces = 100, .tolerance = 0.5, .gather = true};
  EXPECT_LE(plan_together(traits, schedule, wishes).output_error, 0.5);
  wishes.max_form_factors = 150;
  int frames = 0;
  double error = 16.0;
  for (; error > 0.5; ++frames) {
    ASSERT_LT(frames, 100);
    const FramePlan slice = plan_together(traits, schedule, wishes);
    EXPECT_LE(slice.cost, 150u);
    error = slice.output_error;
    schedule = slice.next;
  }
  EXPECT_GT(frames, 5);
}

TEST(Schedule, BarriersStandBetweenStages) {
  const auto traits = traits_of({{0.2, 0.1}, {0.1, 0.2}});
  const FramePlan plan = plan_together(traits, settled(traits), {.bounces = 1, .gather = true});
  // Nodes, imports, two dispatches of rows each, nodes, flips, imports, rows of the gather, outputs.
  std::string kinds;
  for (const FrameStep& step : plan.steps) {
    if (step.barrier_before) kinds += '|';
    kinds += step.kind == FrameStep::Kind::flip      ? 'f'
             : step.kind == FrameStep::Kind::publish ? 'p'
                                                     : "sibmnrg"[static_cast<int>(step.kernel)];
  }
  EXPECT_EQ(kinds, "nn|ii|bbbb|nn|ff|ii|gg|pp");
}

//      imports: (0,0) (0,1) (1,0) sky    albedo
//  K of 0     [ 0     0.4   0.2   0.1 ]   0.5
//             [ 0.2   0     0.1   0.6 ]   1.0 (given)
TEST(SystemTraits, SharesAreTheLargestOfAnyRow) {
  const DrawnSystem zero{{{0, 0}, {0, 1}, {1, 0}, {kSkySystem, 0}},
                         {{0.0, 0.4, 0.2, 0.1}, {0.2, 0.0, 0.1, 0.6}},
                         {{0.5, 0.25, 0.0, 0.0}}};
  const DrawnSystem one{{}, {{}}, {}};
  const Model model = drawn_model({zero, one}, 1);
  const std::vector<Rgb> albedo = {Rgb(0.1, 0.5, 0.2), Rgb(1.0)};
  const SystemTraits traits = system_traits(model, 0, {}, albedo);
  ASSERT_EQ(traits.bounce.shares.size(), 3u);
  // 0.5 x 0.4 and 1 x 0.2; 0.5 x 0.2 and 1 x 0.1; 0.5 x 0.1 and 1 x 0.6.
  EXPECT_NEAR(traits.bounce.shares[0].share, 0.2, 1e-6);
  EXPECT_NEAR(traits.bounce.shares[1].share, 0.1, 1e-6);
  EXPECT_NEAR(traits.bounce.shares[2].share, 0.6, 1e-6);
  EXPECT_EQ(traits.bounce.shares[2].system, 2u);
  // Without the sky: 0.5 x 0.6 and 1 x 0.3.
  EXPECT_NEAR(traits.bounce.total, 0.3, 1e-6);
  EXPECT_NEAR(traits.gather.total, 0.75, 1e-6);
}

TEST(LightingChange, CountsSourcesAndWhatAlbedoReflects) {
  Lighting before;
  before.albedo = {Rgb(0.5), Rgb(0.2), Rgb(0.1)};
  before.exitance = {Rgb(1.0), Rgb(0.0), Rgb(0.0)};
  before.direct = {Rgb(10.0), Rgb(0.0), Rgb(0.0)};
  Lighting after = before;
  after.direct[0] = Rgb(10.0, 4.0, 10.0);  // 0.5 x 6
  EXPECT_DOUBLE_EQ(lighting_change(before, after, 0, 3, 100.0), 3.0);
  EXPECT_DOUBLE_EQ(lighting_change(before, after, 1, 2, 100.0), 0.0);
  after.albedo[2] = Rgb(0.15);  // 0.05 x 100
  EXPECT_NEAR(lighting_change(before, after, 0, 3, 100.0), 5.0, 1e-12);
}

}  // namespace
}  // namespace relume::test
