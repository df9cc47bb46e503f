// SPDX-License-Identifier: MIT
#include "compute/light_schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace relume::test {
namespace {

using testing::HasSubstr;

/// A row of floor blocks, one metre apart along x, facing up, each of two clusters.
std::shared_ptr<const std::vector<LightBlock>> floor_blocks(std::uint32_t count) {
  std::vector<LightBlock> blocks(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    blocks[i].first_element = 32 * i;
    blocks[i].element_count = 32;
    blocks[i].patch_count = 500;
    blocks[i].first_cluster = 2 * i;
    blocks[i].end_cluster = 2 * i + 2;
    blocks[i].centre = {double(i), 0.0, 0.0};
    blocks[i].radius = 0.5;
    blocks[i].axis = {0.0, 1.0, 0.0};
  }
  return std::make_shared<const std::vector<LightBlock>>(blocks);
}

Light lamp(double x, double height, double range) {
  Light light;
  light.intensity = Rgb(1.0);
  light.position = {x, height, 0.0};
  light.range = range;
  return light;
}

std::set<std::uint32_t> traced_blocks(const LightWork& work) {
  std::set<std::uint32_t> blocks;
  for (const LightWork::Trace& trace : work.traces) blocks.insert(trace.block);
  return blocks;
}

TEST(LightSchedule, StartsWithAllBlocksToBeSummedToNothing) {
  LightSchedule schedule(floor_blocks(5), glm::dvec3(0.0), 4, 100);
  EXPECT_FALSE(schedule.complete());
  const LightWork work = schedule.take({});
  EXPECT_EQ(work.sums.size(), 5u);
  EXPECT_TRUE(work.traces.empty() && work.pairs.empty());
  EXPECT_EQ(work.end_cluster, 10u);
  EXPECT_TRUE(schedule.complete());
}

TEST(LightSchedule, TracesWhatALightMayReachAndNothingElse) {
  LightSchedule schedule(floor_blocks(10), glm::dvec3(0.0), 4, 100);
  schedule.take({});
  // Reaches 1.2 m: blocks whose balls of 0.5 m begin nearer than that.
  ASSERT_TRUE(schedule.set_lights(std::vector<Light>{lamp(4.0, 0.1, 1.2)}));
  const LightWork work = schedule.take({});
  EXPECT_EQ(traced_blocks(work), (std::set<std::uint32_t>{3, 4, 5}));
  EXPECT_EQ(work.sums.size(), 3u);
  EXPECT_EQ(work.first_cluster, 6u);
  EXPECT_EQ(work.end_cluster, 12u);
}

TEST(LightSchedule, LightsBehindAllSurfacesAndBesideTheirConeReachNothing) {
  LightSchedule schedule(floor_blocks(10), glm::dvec3(0.0), 8, 100);
  Light down = lamp(0.0, 1.0, 0.0);
  down.type = LightType::spot;
  down.direction = {0.0, -1.0, 0.0};
  down.inner_cone_angle = 0.1;
  down.outer_cone_angle = 0.2;
  Light from_below;
  from_below.type = LightType::directional;
  from_below.direction = {0.0, 1.0, 0.0};
  ASSERT_TRUE(schedule.set_lights(std::vector<Light>{lamp(4.0, -0.5, 0.0), down, from_below}));
  for (const LightWork::Trace& trace : schedule.take({}).traces) {
    EXPECT_EQ(trace.light, 1u);
    EXPECT_LE(trace.block, 1u);
  }
}

TEST(LightSchedule, AMovedLightTracesItsOwnPairsOldAndNew) {
  LightSchedule schedule(floor_blocks(10), glm::dvec3(0.0), 4, 100);
  std::vector<Light> lights{lamp(1.0, 0.1, 1.2), lamp(8.0, 0.1, 1.2)};
  ASSERT_TRUE(schedule.set_lights(lights));
  schedule.take({});
  lights[0].position.x = 3.0;
  ASSERT_TRUE(schedule.set_lights(lights));
  const LightWork work = schedule.take({});
  EXPECT_EQ(traced_blocks(work), (std::set<std::uint32_t>{2, 3, 4}));
  // Blocks that it left are summed anew as well.
  std::set<std::uint32_t> summed;
  for (const LightWork::Sum& sum : work.sums) summed.insert(sum.block);
  EXPECT_EQ(summed, (std::set<std::uint32_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(schedule.pair_count(), 6u);
}

TEST(LightSchedule, AChangeOfColourTracesNothing) {
  LightSchedule schedule(floor_blocks(10), glm::dvec3(0.0), 4, 100);
  std::vector<Light> lights{lamp(1.0, 0.1, 1.2)};
  ASSERT_TRUE(schedule.set_lights(lights));
  schedule.take({});
  lights[0].intensity = Rgb(3.0, 2.0, 1.0);
  ASSERT_TRUE(schedule.set_lights(lights));
  const LightWork work = schedule.take({});
  EXPECT_TRUE(work.traces.empty());
  EXPECT_EQ(work.sums.size(), 3u);
}

// Lamps 2 m above a floor: no point of the nearest block gets more than 1 / 2^2.
TEST(LightSchedule, KnowsHowMuchMayStillChange) {
  LightSchedule schedule(floor_blocks(10), glm::dvec3(0.0), 4, 100);
  EXPECT_EQ(schedule.pending_change(50.0), 50.0);  // what is in the buffers is not known
  schedule.take({});
  EXPECT_EQ(schedule.pending_change(50.0), 0.0);
  std::vector<Light> lights{lamp(2.0, 2.0, 0.0)};
  ASSERT_TRUE(schedule.set_lights(lights));
  EXPECT_NEAR(schedule.pending_change(50.0), 0.25, 1e-4);
  // Nothing taken, and brighter by 2: both come together.
  lights[0].intensity = Rgb(1.0, 3.0, 1.0);
  ASSERT_TRUE(schedule.set_lights(lights));
  EXPECT_NEAR(schedule.pending_change(50.0), 0.75, 1e-4);
  schedule.take({});
  // 7 m on. Most may change a metre beside the old place: the lamp was 2 m above, at least, and is 6 m along
  // and 2 m up from the middle of a ball of 0.5 m.
  lights[0].position.x = 9.0;
  ASSERT_TRUE(schedule.set_lights(lights));
  const double away = std::sqrt(40.0) - 0.5;
  EXPECT_NEAR(schedule.pending_change(50.0), 0.75 + 3.0 / (away * away), 1e-4);
  schedule.take({});
  lights[0].position.y = 0.0;  // inside a block
  ASSERT_TRUE(schedule.set_lights(lights));
  EXPECT_EQ(schedule.pending_change(50.0), 50.0);
  schedule.take({});
  schedule.retrace();
  EXPECT_EQ(schedule.pending_change(50.0), 50.0);
}

TEST(LightSchedule, PartsAddUpToTheWhole) {
  const std::vector<Light> lights{lamp(2.0, 1.0, 0.0), lamp(7.0, 1.0, 0.0)};
  LightSchedule schedule(floor_blocks(10), glm::dvec3(0.0), 4, 100);
  ASSERT_TRUE(schedule.set_lights(lights));
  std::size_t traces = 0, sums = 0, parts = 0;
  while (!schedule.complete()) {
    const LightWork work = schedule.take({3000, ~std::uint64_t{0}});
    traces += work.traces.size();
    sums += work.sums.size();
    ++parts;
  }
  EXPECT_EQ(traces, 20u);
  EXPECT_EQ(sums, 10u);
  EXPECT_GT(parts, 3u);
  // Words: a sum and two traces of 4, two pairs of 2.
  schedule.retrace();
  EXPECT_EQ(schedule.take({~std::uint64_t{0}, 16}).sums.size(), 1u);
  EXPECT_EQ(schedule.take({~std::uint64_t{0}, 47}).sums.size(), 2u);
}

TEST(LightSchedule, SlotsAreGivenBackAndNeverShared) {
  LightSchedule schedule(floor_blocks(10), glm::dvec3(0.0), 8, 20);
  for (int frame = 0; frame < 50; ++frame) {
    ASSERT_TRUE(schedule.set_lights(
        std::vector<Light>{lamp(frame % 10, 1.0, 0.0), lamp((3 * frame) % 10, 1.0, 0.0)}));
    schedule.retrace();
    std::set<std::uint32_t> slots;
    for (const LightWork::Trace& trace : schedule.take({}).traces) {
      EXPECT_LT(trace.slot, 20u);
      EXPECT_TRUE(slots.insert(trace.slot).second);
    }
    EXPECT_EQ(slots.size(), 20u);
  }
}

TEST(LightSchedule, RefusesMoreThanItsLimitsAndStaysAsItWas) {
  LightSchedule schedule(floor_blocks(10), glm::dvec3(0.0), 2, 15);
  const std::vector<Light> one{lamp(1.0, 1.0, 0.0)};
  ASSERT_TRUE(schedule.set_lights(one));
  const auto pairs = schedule.set_lights(std::vector<Light>(2, one[0]));
  ASSERT_FALSE(pairs);
  EXPECT_THAT(pairs.error().message, HasSubstr("at most 15 pairs"));
  EXPECT_THAT(pairs.error().message, HasSubstr("found 20"));
  const auto lights = schedule.set_lights(std::vector<Light>(3, one[0]));
  ASSERT_FALSE(lights);
  EXPECT_THAT(lights.error().message, HasSubstr("at most 2 lights, found 3"));
  EXPECT_EQ(schedule.pair_count(), 10u);
  EXPECT_EQ(schedule.take({}).traces.size(), 10u);
}

}  // namespace
}  // namespace relume::test
