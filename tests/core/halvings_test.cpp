// SPDX-License-Identifier: MIT
#include "core/halvings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "support/tiny_model.h"

namespace relume {
namespace {

HalvingList halvings_of(const std::vector<double>& leaves) {
  HalvingList list;
  append_halvings(
      std::uint32_t(leaves.size()),
      [&](std::uint32_t first, std::uint32_t last) {
        return std::accumulate(leaves.begin() + first, leaves.begin() + last, 0.0);
      },
      list);
  return list;
}

double most(const HalvingList& list, const std::vector<double>& worth) {
  std::uint64_t next = 0;
  const auto value = [&](std::uint32_t leaf) { return worth[leaf]; };
  const double result = most_of_halves<double>(list.bytes(), 0, std::uint32_t(worth.size()), next, value);
  EXPECT_EQ(next, list.size());
  return result;
}

TEST(Halvings, SayWhatHalvesGet) {
  const HalvingList list = halvings_of({0.5, 0.0, 0.3, 0.2});
  ASSERT_EQ(list.size(), 3u);  // half to each; all of that to leaf 0; more to leaf 2 than to leaf 3
  EXPECT_EQ(halving_at(list.bytes(), 0), Halving::second_least);
  EXPECT_EQ(halving_at(list.bytes(), 1), Halving::first);
  EXPECT_EQ(halving_at(list.bytes(), 2), Halving::first_more);
  EXPECT_EQ(most(list, {1.0, 9.0, 3.0, 5.0}), 4.0);  // leaves 2 and 3 alike, all of it there
  EXPECT_EQ(most(list, {7.0, 9.0, 3.0, 1.0}), 5.0);  // leaf 2 alone; half of it with leaf 0
  EXPECT_EQ(halvings_of({0.0, 0.0, 0.0}).size(), 0u);
  EXPECT_EQ(halvings_of({1.0}).size(), 0u);
}

TEST(Halvings, LeaveNothingOpenWhereOneLeafGetsAll) {
  for (std::uint32_t count = 2; count < 40; ++count) {
    std::vector<double> leaves(count, 0.0), worth(count);
    std::iota(worth.begin(), worth.end(), 1.0);
    for (std::uint32_t leaf = 0; leaf < count; ++leaf) {
      leaves.assign(count, 0.0), leaves[leaf] = 0.25;
      EXPECT_EQ(most(halvings_of(leaves), worth), worth[leaf]) << leaf << " of " << count;
    }
  }
}

TEST(Halvings, HoldWhateverIsSharedOut) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<double> shares(2 + trial % 30), worth(shares.size());
    for (double& share : shares) share = std::max(any(random), 0.0);
    for (double& value : worth) value = any(random);
    const double all = std::accumulate(shares.begin(), shares.end(), 0.0);
    if (all <= 0.0) continue;
    const double exact = std::inner_product(shares.begin(), shares.end(), worth.begin(), 0.0) / all;
    const HalvingList list = halvings_of(shares);
    EXPECT_LE(exact, most(list, worth) + 1e-12);
    for (double& value : worth) value = -value;
    EXPECT_GE(exact, -most(list, worth) - 1e-12);
  }
}

/// The floor sees a node of both systems' clusters and the sky, of one patch.
Model model_with_node() {
  Model model = test::tiny_model();
  System& lid = model.systems[1];
  lid.clusters.push_back(lid.clusters[0]);
  lid.clusters[1].first_element = 1;
  lid.elements.push_back(lid.elements[0]);
  lid.elements[1].cluster = 1;
  lid.elements[0].piece_count = lid.elements[1].piece_count = 1;
  lid.elements[1].first_piece = 1;
  lid.rays.push_back(lid.rays[0]);
  lid.tree = {{{0, 2, 0}}, {0.5f, 0.5f}};
  BlockMatrixBuilder bounce(1, ValueCodec::f32);
  for (int row = 0; row < 2; ++row)
    bounce.append_row(std::vector<std::uint16_t>{0}, std::vector<double>{0.2});
  lid.bounce = std::move(bounce).finish();
  model.systems[0].imports[0] = {1, 2};
  return model;
}

TEST(Halvings, OfAModelAreAsManyAsItsRowsSeeNodes) {
  Model model = model_with_node();
  const auto plain = check_model(model);
  ASSERT_TRUE(plain) << plain.error().message;
  System& floor = model.systems[0];
  EXPECT_EQ(leaves_of_columns(model, floor), (std::vector<std::uint32_t>{2, 1}));
  floor.bounce_halvings = {std::uint8_t(Halving::first_more)};  // of one row
  floor.gather_halvings = {0b0110};                             // of two
  EXPECT_TRUE(check_model(model)) << check_model(model).error().message;
  const auto offsets = halving_offsets(floor.gather, leaves_of_columns(model, floor), floor.gather_halvings);
  EXPECT_EQ(offsets.value(), (std::vector<std::uint64_t>{0, 1, 2}));

  const auto refused = [&](const std::vector<std::uint8_t>& bounce, const std::vector<std::uint8_t>& gather) {
    floor.bounce_halvings = bounce, floor.gather_halvings = gather;
    const auto checked = check_model(model);
    return !checked && checked.error().code == ErrorCode::check_failed &&
           checked.error().message.find("halvings of all nodes") != std::string::npos;
  };
  EXPECT_TRUE(refused({3, 0}, {})) << "too long";
  EXPECT_TRUE(refused({0b0100}, {})) << "bits after the last";
  EXPECT_TRUE(refused({}, {0b010110})) << "the same";
  model.systems[1].gather_halvings = {1};  // the lid sees no node
  EXPECT_TRUE(refused({}, {}));
}

TEST(Halvings, ThatEndTooSoonAreRefused) {
  BlockMatrixBuilder builder(1, ValueCodec::f32);
  for (int row = 0; row < 3; ++row)
    builder.append_row(std::vector<std::uint16_t>{0}, std::vector<double>{0.2});
  const BlockMatrix matrix = std::move(builder).finish();
  const std::vector<std::uint32_t> leaves{4};
  const std::vector<std::uint8_t> bytes{0xff, 0xff};  // both halves always: 3 of each row
  EXPECT_FALSE(halving_offsets(matrix, leaves, bytes));
  EXPECT_TRUE(halving_offsets(matrix, leaves, std::vector<std::uint8_t>{0xff, 0xff, 0x03}));
}

}  // namespace
}  // namespace relume
