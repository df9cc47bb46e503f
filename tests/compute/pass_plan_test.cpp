// SPDX-License-Identifier: MIT
#include "compute/pass_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "compute/test_models.h"

namespace relume::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

SolverLayout layout_of(const Model& model, const LayoutLimits& limits = {}) {
  auto layout = solver_layout(model, limits);
  EXPECT_TRUE(layout) << layout.error().message;
  return layout ? *layout : SolverLayout{};
}

//   rows of 3, 1, 0, 2 and 4 entries
Model five_rows(std::size_t max_block_bytes = kMaxBlockBytes) {
  DrawnSystem drawn{{{0, 0}, {0, 1}, {0, 2}, {0, 3}},
                    {{0.1, 0.1, 0.1, 0.0},
                     {0.0, 0.0, 0.0, 0.3},
                     {0.0, 0.0, 0.0, 0.0},
                     {0.2, 0.0, 0.2, 0.0},
                     {0.1, 0.1, 0.1, 0.1}},
                    {}};
  return drawn_model({drawn}, 0, {ValueCodec::f32, max_block_bytes});
}

TEST(PassPlan, CutsWhereTheNextRowWouldNotFit) {
  const Model model = five_rows();
  const Pass pass = plan_pass(model, layout_of(model), StepKernel::bounce, RowKernel::row_per_thread, 4);
  // Imports, rows 0 to 2 (3 + 1 + 0 entries), row 3, row 4.
  ASSERT_EQ(pass.size(), 4u);
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> count;
  std::vector<std::uint64_t> cost;
  for (const DispatchStep& step : pass) {
    first.push_back(step.range.first_row);
    count.push_back(step.range.count);
    cost.push_back(step.cost);
  }
  EXPECT_THAT(first, ElementsAre(0u, 0u, 3u, 4u));
  EXPECT_THAT(count, ElementsAre(4u, 3u, 1u, 1u));
  EXPECT_THAT(cost, ElementsAre(4u, 4u, 2u, 4u));
  EXPECT_EQ(pass_cost(pass), 14u);
}

TEST(PassPlan, ARowLargerThanTheLimitIsADispatchOfItsOwn) {
  const Model model = five_rows();
  const Pass pass = plan_pass(model, layout_of(model), StepKernel::bounce, RowKernel::row_per_8_lanes, 1);
  std::vector<std::uint32_t> count;
  for (const DispatchStep& step : pass) count.push_back(step.range.count);
  EXPECT_THAT(count, ElementsAre(4u, 1u, 2u, 1u, 1u));
}

TEST(PassPlan, RowsOfAllBlocksAreCoveredOnce) {
  const Model model = random_model({}, 1, {ValueCodec::f32, 300});
  const SolverLayout layout = layout_of(model);
  for (const StepKernel kernel : {StepKernel::bounce, StepKernel::gather}) {
    std::vector<std::vector<int>> covered;
    for (const System& system : model.systems) {
      covered.emplace_back(kernel == StepKernel::bounce ? system.bounce.rows : system.gather.rows, 0);
    }
    for (const DispatchStep& step : plan_pass(model, layout, kernel, RowKernel::row_per_8_lanes, 50)) {
      if (step.kernel == StepKernel::import_radiosity) continue;
      EXPECT_EQ(step.kernel, kernel);
      EXPECT_EQ(step.workgroups, (step.range.count + 7) / 8);
      for (std::uint32_t i = 0; i < step.range.count; ++i) {
        ++covered[step.system][step.range.block_row + step.range.first_row + i];
      }
    }
    for (const std::vector<int>& rows : covered) EXPECT_THAT(rows, testing::Each(1));
  }
}

TEST(PassPlan, NoDispatchHasMoreWorkgroupsThanEveryDeviceAllows) {
  // 70 000 empty rows in one block: 8750 workgroups of 8 rows fit one dispatch, a million rows do not.
  MatrixBlock block;
  block.row_count = 1'000'000;
  block.tile_offsets.assign(block.row_count + 1, 0);
  Model model;
  System& system = model.systems.emplace_back();
  system.bounce = {block.row_count, 0, {block}};
  const Pass pass = plan_pass(model, layout_of(model), StepKernel::bounce, RowKernel::row_per_8_lanes, 100);
  ASSERT_EQ(pass.size(), 2u);
  EXPECT_EQ(pass[0].workgroups, 65535u);
  EXPECT_EQ(pass[0].range.count, 65535u * 8u);
  EXPECT_EQ(pass[1].range.first_row, 65535u * 8u);
  EXPECT_EQ(pass[0].range.count + pass[1].range.count, 1'000'000u);
}

TEST(PassPlan, ABarrierStandsBetweenImportsAndRows) {
  const DrawnSystem one{{{0, 0}}, {{0.5}}, {}};
  const DrawnSystem two{{{0, 0}}, {{0.5}, {0.5}}, {}};
  const Model model = drawn_model({one, two}, 0);
  const Pass pass = plan_pass(model, layout_of(model), StepKernel::bounce, RowKernel::row_per_thread, 1);
  std::vector<bool> barriers;
  for (const DispatchStep& step : pass) barriers.push_back(step.barrier_before);
  // Two imports, the row of system 0, both rows of system 1.
  EXPECT_THAT(barriers, ElementsAre(false, false, true, false, false));
}

TEST(SolverLayout, SendersAreNumberedThrough) {
  const DrawnSystem three{{}, {{}, {}, {}}, {}};
  const DrawnSystem seventeen{{}, DenseMatrix(17), {}};
  const Model model = drawn_model({three, seventeen}, 5);
  const SolverLayout layout = layout_of(model);
  EXPECT_EQ(layout.systems[1].first_cluster, 3u);
  EXPECT_EQ(layout.buffers[kRadiosityA].byte_size, 25u * 16u);
  EXPECT_EQ(layout.buffers[kAlbedo].byte_size, 20u * 16u);
}

TEST(SolverLayout, SectionsOfABlockAreAlignedAndDoNotOverlap) {
  const SolverLayout layout = layout_of(five_rows(), {1u << 20, 64});
  const BlockLayout& block = layout.systems[0].bounce.at(0);
  // 6 offsets, 10 columns, 10 values, 5 scales.
  const VkDeviceSize bytes[] = {24, 20, 40, 20};
  VkDeviceSize end = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(block.sections[i].offset % 64, 0u);
    EXPECT_GE(block.sections[i].offset, end);
    EXPECT_EQ(block.sections[i].byte_size, bytes[i]);
    end = block.sections[i].offset + block.sections[i].byte_size;
  }
  EXPECT_EQ(layout.buffers[block.buffer].byte_size, end);
}

TEST(SolverLayout, RefusesABufferThatTheDeviceCannotBind) {
  const auto layout = solver_layout(five_rows(), {64, 16});
  ASSERT_FALSE(layout);
  EXPECT_EQ(layout.error().code, ErrorCode::no_device);
  EXPECT_THAT(layout.error().message, HasSubstr("'radiosity a' needs 80 bytes"));
}

TEST(PassPlan, TilesAreNotTakenApart) {
  // 20 rows of 4 entries in tiles of 8, 8 and 4 rows: 32 form factors a tile.
  const DrawnSystem drawn{{{0, 0}, {0, 1}, {0, 2}, {0, 3}}, DenseMatrix(20, {0.1, 0.2, 0.3, 0.1}), {}};
  const Model model = drawn_model({drawn}, 0, {ValueCodec::f32, kMaxBlockBytes, 8});
  const Pass pass = plan_pass(model, layout_of(model), StepKernel::bounce, RowKernel::row_per_thread, 70);
  ASSERT_EQ(pass.size(), 3u);
  EXPECT_EQ(pass[1].range.count, 16u);
  EXPECT_EQ(pass[1].cost, 64u);
  EXPECT_EQ(pass[2].range.first_row, 16u);
  EXPECT_EQ(pass[2].range.count, 4u);
}

}  // namespace
}  // namespace relume::test
