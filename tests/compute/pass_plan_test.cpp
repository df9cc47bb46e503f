// SPDX-License-Identifier: MIT
#include "compute/pass_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "compute/test_models.h"
#include "kernels/shared/limits.h"

namespace relume::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

SystemLayout layout_of(const Model& model, const LayoutLimits& limits = {}) {
  auto layout = system_layout(model, 0, limits);
  EXPECT_TRUE(layout) << layout.error().message;
  return layout ? *layout : SystemLayout{};
}

std::vector<DispatchStep> bounce_of(const Model& model, RowKernel kernel, std::uint64_t max_form_factors) {
  const SystemDispatches all =
      plan_dispatches(model.systems[0], layout_of(model), kernel, MatrixFetch::storage, max_form_factors);
  return dispatches_of(all, StepKernel::bounce);
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
  // Rows 0 to 2 (3 + 1 + 0 entries), row 3, row 4.
  const std::vector<DispatchStep> steps = bounce_of(five_rows(), RowKernel::row_per_thread, 4);
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> count;
  std::vector<std::uint64_t> cost;
  for (const DispatchStep& step : steps) {
    first.push_back(step.range.first_row);
    count.push_back(step.range.count);
    cost.push_back(step.cost);
  }
  EXPECT_THAT(first, ElementsAre(0u, 3u, 4u));
  EXPECT_THAT(count, ElementsAre(3u, 1u, 1u));
  EXPECT_THAT(cost, ElementsAre(4u, 2u, 4u));
  EXPECT_EQ(dispatch_cost(steps), 10u);
}

// The same cuts as for 4 form factors of one lighting.
TEST(PassPlan, AFormFactorCountsOnceForEachLighting) {
  const Model model = five_rows();
  LayoutLimits limits;
  limits.lightings = 3;
  const SystemDispatches all = plan_dispatches(model.systems[0], layout_of(model, limits),
                                               RowKernel::row_per_thread, MatrixFetch::storage, 14);
  std::vector<std::uint64_t> cost;
  for (const DispatchStep& step : dispatches_of(all, StepKernel::bounce)) {
    cost.push_back(step.cost);
    EXPECT_EQ(step.lightings, 1u);  // in an invocation
  }
  EXPECT_THAT(cost, ElementsAre(12u, 6u, 12u));
  EXPECT_EQ(dispatches_of(all, StepKernel::start).at(0).lightings, 3u);
  EXPECT_EQ(dispatches_of(all, StepKernel::start).at(0).cost, 15u);
}

TEST(PassPlan, ARowLargerThanTheLimitIsADispatchOfItsOwn) {
  std::vector<std::uint32_t> count;
  for (const DispatchStep& step : bounce_of(five_rows(), RowKernel::row_per_8_lanes, 1))
    count.push_back(step.range.count);
  EXPECT_THAT(count, ElementsAre(1u, 2u, 1u, 1u));
}

TEST(PassPlan, RowsOfAllBlocksAreCoveredOnce) {
  const Model model = random_model({}, 1, {ValueCodec::f32, 300});
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    const auto layout = system_layout(model, s, {});
    ASSERT_TRUE(layout);
    const SystemDispatches all =
        plan_dispatches(system, *layout, RowKernel::row_per_8_lanes, MatrixFetch::texels, 50);
    for (const StepKernel kernel : {StepKernel::bounce, StepKernel::gather}) {
      std::vector<int> covered(kernel == StepKernel::bounce ? system.bounce.rows : system.gather.rows, 0);
      for (const DispatchStep& step : dispatches_of(all, kernel)) {
        EXPECT_EQ(step.workgroups, (step.range.count + 7) / 8);
        EXPECT_EQ(step.format.fetch, MatrixFetch::texels);
        for (std::uint32_t i = 0; i < step.range.count; ++i)
          ++covered[step.range.block_row + step.range.first_row + i];
      }
      EXPECT_THAT(covered, testing::Each(1));
    }
  }
}

// Workgroup (x, y) of a tile kernel does workgroup kSweeps x + y of rows.
TEST(PassPlan, SweepsCoverAllRowsWithoutAWorkgroupTooMany) {
  for (const std::uint32_t rows : {1u, 64u, 65u, 1024u, 1025u, 5000u}) {
    MatrixBlock block;
    block.tile_rows = 8;
    block.row_count = rows;
    block.tile_offsets.assign((rows + 7) / 8 + 1, 0);
    Model model;
    model.systems.emplace_back().bounce = {rows, 0, {block}};
    const std::vector<DispatchStep> steps = bounce_of(model, RowKernel::tile_shuffle, 100);
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_EQ(steps[0].sweeps, kernels::kSweeps);
    EXPECT_GE(steps[0].workgroups * steps[0].sweeps * kernels::kWorkgroupSize, rows);
    EXPECT_LT((steps[0].workgroups - 1) * steps[0].sweeps * kernels::kWorkgroupSize, rows);
  }
}

TEST(PassPlan, AllProbesAreCoveredOnce) {
  const Model model = random_model({.probes = 40}, 2);
  const System& system = model.systems[1];
  const auto layout = system_layout(model, 1, {});
  ASSERT_TRUE(layout);
  const SystemDispatches all =
      plan_dispatches(system, *layout, RowKernel::row_per_8_lanes, MatrixFetch::texels, 500);
  std::uint32_t next = 0;
  std::uint64_t cost = 0;
  for (const DispatchStep& step : dispatches_of(all, StepKernel::probes)) {
    EXPECT_EQ(step.range.first_row, next);
    EXPECT_EQ(step.workgroups, (step.range.count + 7) / 8);
    EXPECT_TRUE(step.cost <= 500 || step.range.count == 1);
    next += step.range.count;
    cost += step.cost;
  }
  EXPECT_EQ(next, 40u);
  EXPECT_EQ(cost, system.probe_senders.size() * kProbeEntryCost);
}

TEST(PassPlan, NoDispatchHasMoreWorkgroupsThanEveryDeviceAllows) {
  // 70 000 empty rows in one block: 8750 workgroups of 8 rows fit one dispatch, a million rows do not.
  MatrixBlock block;
  block.row_count = 1'000'000;
  block.tile_offsets.assign(block.row_count + 1, 0);
  Model model;
  System& system = model.systems.emplace_back();
  system.bounce = {block.row_count, 0, {block}};
  const std::vector<DispatchStep> steps = bounce_of(model, RowKernel::row_per_8_lanes, 100);
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[0].workgroups, 65535u);
  EXPECT_EQ(steps[0].range.count, 65535u * 8u);
  EXPECT_EQ(steps[1].range.first_row, 65535u * 8u);
  EXPECT_EQ(steps[0].range.count + steps[1].range.count, 1'000'000u);
}

TEST(PassPlan, NodesAreCoveredOnceInDispatchesThatEveryDeviceAllows) {
  NodeTables tables{std::vector<kernels::uvec4>(600'000, kernels::uvec4{0, 9, 0, 0}), {}, 0};
  const std::vector<DispatchStep> large = plan_nodes(tables, RowKernel::tile_shared, MatrixFetch::storage);
  ASSERT_EQ(large.size(), 2u);
  EXPECT_EQ(large[0].workgroups, 65535u);
  EXPECT_EQ(large[1].range.first_row, 65535u * 8u);
  EXPECT_EQ(large[1].range.count, 600'000u - 65535u * 8u);
  EXPECT_EQ(dispatch_cost(large), 5'400'000u);
  EXPECT_TRUE(plan_small_nodes(tables, MatrixFetch::storage).empty());

  tables.small = 65;
  const std::vector<DispatchStep> small = plan_small_nodes(tables, MatrixFetch::storage);
  ASSERT_EQ(small.size(), 1u);
  EXPECT_EQ(small[0].workgroups, 2u);
  EXPECT_EQ(small[0].range.count, 65u);
  EXPECT_EQ(plan_nodes(tables, RowKernel::tile_shared, MatrixFetch::storage)[0].range.first_row, 65u);
}

TEST(PassPlan, WhatASystemDoesNotHaveIsNotDispatched) {
  const Model model = drawn_model({{{}, {}, {}}}, 0);
  const SystemDispatches all =
      plan_dispatches(model.systems[0], layout_of(model), RowKernel::row_per_thread, MatrixFetch::storage, 1);
  for (const std::vector<DispatchStep>& steps : all) EXPECT_TRUE(steps.empty());
}

TEST(SolverLayout, ThereIsRoomForTheSkyAndTwoHalvesOfEverySystemWhereBindingsMayBegin) {
  const DrawnSystem three{{}, {{}, {}, {}}, {}};
  const DrawnSystem seventeen{{}, DenseMatrix(17), {}};
  Model model = drawn_model({three, seventeen}, 5);
  model.systems[1].tree = {{{0, 4, 0}, {4, 2, 4}}, std::vector<float>(6, 0.25f)};
  EXPECT_EQ(loaded_senders(model), 22u);
  const auto layout = solver_layout(model, loaded_senders(model), {});
  ASSERT_TRUE(layout);
  // 5 of the sky end before the 16th; 44, and up to 15 places that systems leave, before the 80th.
  EXPECT_EQ(layout->buffers[kRadiosity].byte_size, (16u + 80u) * 16u);
  const auto system = system_layout(model, 1, {});
  ASSERT_TRUE(system);
  EXPECT_EQ(system->senders(), 19u);
  EXPECT_EQ(system->buffers[kAlbedo].byte_size, 17u * 16u);
}

// Of 17 clusters (272 bytes), planes 512 bytes apart; of imports side by side.
TEST(SolverLayout, LightingsLieInPlanesThatCanBeBoundEach) {
  const DrawnSystem drawn{{{0, 0}, {0, 1}, {0, 2}}, DenseMatrix(17), DenseMatrix(5)};
  const Model model = drawn_model({drawn}, 5);
  LayoutLimits limits;
  limits.lightings = 3;
  const SystemLayout system = layout_of(model, limits);
  EXPECT_EQ(system.clusters_plane.byte_size, 17u * 16u);
  EXPECT_EQ(system.clusters_plane.step, 512u);
  EXPECT_EQ(system.buffers[kAlbedo].byte_size, 17u * 16u);
  EXPECT_EQ(system.buffers[kExitance].byte_size, 3u * 512u);
  EXPECT_EQ(system.buffers[kDirect].byte_size, 3u * 512u);
  EXPECT_EQ(system.buffers[kIrradiance].byte_size, 3u * 256u);
  EXPECT_EQ(system.buffers[kLocalRadiosity].byte_size, 3u * 3u * 16u);
  const auto solve = solver_layout(model, 17, limits);
  ASSERT_TRUE(solve);
  // The 5 of the sky end before place 16, 2 x 17 and up to 15 more 64 places on: 80 of 16 bytes.
  EXPECT_EQ(solve->radiosity_plane.step, 1280u);
  EXPECT_EQ(solve->buffers[kRadiosity].byte_size, 3u * 1280u);
  EXPECT_EQ(solve->buffers[kResiduals].byte_size, 3u * 64u);
}

TEST(SolverLayout, SectionsOfABlockAreAlignedAndDoNotOverlap) {
  const SystemLayout layout = layout_of(five_rows(), {1u << 20, 64});
  const BlockLayout& block = layout.bounce.at(0);
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
  const Model model = five_rows();
  const auto layout = solver_layout(model, 5, {64, 16});
  ASSERT_FALSE(layout);
  EXPECT_EQ(layout.error().code, ErrorCode::no_device);
  EXPECT_THAT(layout.error().message, HasSubstr("'radiosity' needs 160 bytes"));
  const auto system = system_layout(model, 0, {64, 16});
  ASSERT_FALSE(system);
  EXPECT_THAT(system.error().message, HasSubstr("'system 0 albedo' needs 80 bytes"));
}

TEST(PassPlan, TilesAreNotTakenApart) {
  // 20 rows of 4 entries in tiles of 8, 8 and 4 rows: 32 form factors a tile.
  const DrawnSystem drawn{{{0, 0}, {0, 1}, {0, 2}, {0, 3}}, DenseMatrix(20, {0.1, 0.2, 0.3, 0.1}), {}};
  const Model model = drawn_model({drawn}, 0, {ValueCodec::f32, kMaxBlockBytes, 8});
  const std::vector<DispatchStep> steps = bounce_of(model, RowKernel::row_per_thread, 70);
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[0].range.count, 16u);
  EXPECT_EQ(steps[0].cost, 64u);
  EXPECT_EQ(steps[1].range.first_row, 16u);
  EXPECT_EQ(steps[1].range.count, 4u);
}

}  // namespace
}  // namespace relume::test
