// SPDX-License-Identifier: MIT
//
// Rows that receive light from where they cannot see, in models small enough to say how much.
#include "precompute/leak_meter.h"

#include <gtest/gtest.h>

#include "support/quad_model.h"

namespace relume::test {
namespace {

constexpr glm::dvec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

/// Walls that block and are nothing else.
void add_box(Model& model, const glm::dvec3& lower, const glm::dvec3& upper) {
  for (const Quad& quad : box_quads(lower, upper, true)) add_quad(model, quad, 0);
}

/// `rows` rows, all empty but [first, first + count): there column 0 holds `value`.
BlockMatrix one_column(std::uint32_t rows, std::uint32_t first, std::uint32_t count, double value) {
  BlockMatrixBuilder builder(1, ValueCodec::f32);
  for (std::uint32_t row = 0; row < rows; ++row) {
    const bool filled = row >= first && row < first + count;
    const std::array<std::uint16_t, 1> columns{0};
    const std::array<double, 1> values{value};
    builder.append_row(std::span(columns).first(filled ? 1 : 0), std::span(values).first(filled ? 1 : 0));
  }
  return std::move(builder).finish();
}

/// The last cluster and its lumels receive `value` from `sender`; nothing else is received.
void let_last_receive(Model& model, const SenderRef& sender, double value) {
  System& system = model.systems[0];
  system.imports = {sender};
  const auto clusters = std::uint32_t(system.clusters.size()), lumels = std::uint32_t(system.lumels.size());
  const std::uint32_t own = system.clusters.back().element_count;
  system.bounce = one_column(clusters, clusters - 1, 1, value);
  system.gather = one_column(lumels, lumels - own, own, value);
}

/// Two sealed rooms, of 1 x 1 x 1 and 3 x 1 x 1 m, a metre apart. Clusters: their floors (1 and 3 m2), then
/// the ceiling of the first. Sender 3 is the node of both floors.
Model two_floors() {
  Model model;
  model.origin = {100.0, 0.0, 0.0};
  add_quad(model, {{100, 0, 0}, kZ, kX}, 2);
  add_quad(model, {{102, 0, 0}, kZ, 3.0 * kX}, 2);
  add_quad(model, {{100, 1, 0}, kX, kZ}, 2);
  add_box(model, {100, 0, 0}, {101, 1, 1});
  add_box(model, {102, 0, 0}, {105, 1, 1});
  model.systems[0].tree = {{{0, 2, 0}}, {0.25f, 0.75f}};
  return model;
}

LeakReport measured(const Model& model, const LeakOptions& options = {}) {
  const Result<LeakReport> report = measure_leaks(model, options);
  if (!report) throw std::runtime_error(report.error().message);
  return *report;
}

TEST(LeakMeter, FindsTheFloorOfTheOtherRoomInANode) {
  Model model = two_floors();
  let_last_receive(model, {0, 3}, 0.4);
  const LeakReport report = measured(model);
  // 3 m2 of the node's 4 are in the other room. The ceiling is 4 of 12 lumels, and 1 of 3 clusters.
  EXPECT_EQ(report.lumels.rows, 12u);
  EXPECT_EQ(report.clusters.rows, 3u);
  for (const LeakSummary& summary : {report.lumels, report.clusters}) {
    EXPECT_NEAR(summary.largest_hidden, 0.3, 1e-7);
    EXPECT_NEAR(summary.largest_walled, 0.3, 1e-7);
    EXPECT_NEAR(summary.mean_hidden, 0.1, 1e-7);
    EXPECT_NEAR(summary.mean_walled, 0.1, 1e-7);
  }
  const auto worst = worst_leaks(report, &RowLeak::walled, 10);
  ASSERT_EQ(worst.size(), 5u);
  const RowLeak& ceiling = worst.back();
  EXPECT_EQ(ceiling.kind, LeakReceiver::cluster);
  EXPECT_EQ(ceiling.index, 2u);
  EXPECT_EQ(ceiling.node, 2u);
  EXPECT_EQ(ceiling.place, glm::dvec3(100.5, 1.0, 0.5));
  EXPECT_EQ(ceiling.sender, (SenderRef{0, 1}));
  EXPECT_EQ(ceiling.sender_node, 1u);
  EXPECT_EQ(ceiling.sender_place, glm::dvec3(103.5, 0.0, 0.5));
}

TEST(LeakMeter, SaysNothingWhereAllIsSeen) {
  Model model = two_floors();
  let_last_receive(model, {0, 0}, 0.4);
  const LeakReport report = measured(model);
  EXPECT_EQ(report.lumels.largest_hidden, 0.0);
  EXPECT_EQ(report.lumels.largest_walled, 0.0);
  EXPECT_EQ(report.clusters.largest_hidden, 0.0);
  EXPECT_EQ(report.clusters.largest_walled, 0.0);
  EXPECT_TRUE(worst_leaks(report, &RowLeak::hidden, 10).empty());
}

TEST(LeakMeter, FindsAClusterOnTwoSidesOfAWall) {
  Model model;
  add_quad(model, {{0, 0, 0}, kZ, 2.0 * kX}, 4);
  add_quad(model, {{0, 1, 0}, kX, kZ}, 1);
  add_box(model, {0, 0, 0}, {2, 1, 1});
  add_quad(model, {{1, 0, 0}, kY, kZ}, 0);
  let_last_receive(model, {0, 0}, 0.6);
  const LeakReport report = measured(model);
  // It is seen, but half of it is behind the wall.
  EXPECT_EQ(report.lumels.largest_hidden, 0.0);
  EXPECT_NEAR(report.lumels.largest_walled, 0.3, 1e-7);
}

TEST(LeakMeter, TellsCornersFromWalls) {
  // Low at one end of a room of 4 x 2 x 1 m, with a screen of half its height across the middle: the floor
  // behind it is out of sight, but not of the ceiling and the far wall.
  Model model;
  add_quad(model, {{2.2, 0, 0}, kZ, 1.8 * kX}, 2);
  add_quad(model, {{0.1, 0, 0}, 0.2 * kY, kZ}, 1);
  add_box(model, {0, 0, 0}, {4, 2, 1});
  add_quad(model, {{2, 0, 0}, kY, kZ}, 0);
  let_last_receive(model, {0, 0}, 0.2);
  const LeakReport report = measured(model);
  EXPECT_NEAR(report.lumels.largest_hidden, 0.2, 1e-7);
  EXPECT_EQ(report.lumels.largest_walled, 0.0);
  EXPECT_NEAR(report.clusters.largest_hidden, 0.2, 1e-7);
  EXPECT_EQ(report.clusters.largest_walled, 0.0);
}

TEST(LeakMeter, LooksAtAsManyRowsAsAskedForOnAnyNumberOfThreads) {
  Model model = two_floors();
  let_last_receive(model, {0, 3}, 0.4);
  model.systems[0].lumels[0].flags = kLumelInvalid;
  EXPECT_EQ(measured(model).lumels.rows, 11u);
  const LeakReport few = measured(model, {2, 1}), same = measured(model, {2, 3});
  EXPECT_EQ(few.lumels.rows, 2u);
  EXPECT_EQ(few.clusters.rows, 2u);
  ASSERT_EQ(few.rows.size(), same.rows.size());
  for (std::size_t i = 0; i < few.rows.size(); ++i) {
    EXPECT_EQ(few.rows[i].index, same.rows[i].index);
    EXPECT_EQ(few.rows[i].hidden, same.rows[i].hidden);
  }
}

}  // namespace
}  // namespace relume::test
