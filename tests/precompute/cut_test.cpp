// SPDX-License-Identifier: MIT
//
// Cluster trees and cuts drawn by hand.
#include "precompute/cut.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "precompute/coarsen_imports.h"
#include "precompute/cut_rows.h"

namespace relume::test {
namespace {

TreeLeaf leaf_at(float x, std::uint32_t group, float area = 1.0f) {
  return {{x, 0, 0}, {0, 1, 0}, area, group};
}

/// Eight leaves of 1 m2 in a row, numbered as they lie.
ClusterTree tree_of_eight(std::uint32_t groups = 1) {
  std::vector<TreeLeaf> leaves;
  for (std::uint32_t i = 0; i < 8; ++i) leaves.push_back(leaf_at(float(i), i * groups / 8));
  ClusterTree tree;
  append_tree(leaves, 0, tree);
  return tree;
}

const std::vector<double> kOnes(8, 1.0);
constexpr std::uint32_t kManyRays = 1u << 30;

std::vector<TreeNodeRange> ranges(const ClusterTree& tree, const CutTile& tile) {
  std::vector<TreeNodeRange> result;
  for (const auto node : tile.nodes) result.push_back(tree.nodes[node]);
  return result;
}

TEST(ClusterTree, OrdersByGroupThenAlongTheLongestDirection) {
  const auto order = tree_order({leaf_at(3, 1), leaf_at(1, 0), leaf_at(0, 1), leaf_at(0, 0), leaf_at(2, 1)});
  EXPECT_EQ(order, (std::vector<std::uint32_t>{3, 1, 2, 4, 0}));
}

TEST(ClusterTree, HalvesByAreaAndNumbersChildrenSideBySide) {
  ClusterTree tree;
  append_tree({leaf_at(0, 0, 3.0f), leaf_at(1, 0), leaf_at(2, 0)}, 10, tree);
  ASSERT_EQ(tree.nodes.size(), 5u);
  EXPECT_EQ(tree.roots, (std::vector<std::uint32_t>{0}));
  // 3 m2 of 5 are more than half.
  EXPECT_EQ(tree.nodes[tree.nodes[0].left].first, 10u);
  EXPECT_EQ(tree.nodes[tree.nodes[0].left].count, 1u);
  EXPECT_EQ(tree.nodes[tree.nodes[0].left + 1].first, 11u);
  EXPECT_EQ(tree.nodes[tree.nodes[0].left + 1].count, 2u);
}

TEST(ClusterTree, NoNodeMixesGroups) {
  const ClusterTree tree = tree_of_eight(4);
  EXPECT_EQ(tree.roots.size(), 4u);
  for (const auto root : tree.roots) EXPECT_EQ(tree.nodes[root].count, 2u);
}

TEST(ClusterTree, AboveThePartsNodesHoldWholeParts) {
  // Part 1 lies at both ends of part 0 by its leaves, but right of it by its middle. Part 2 is far out.
  std::vector<TreeLeaf> leaves{leaf_at(2, 0), leaf_at(1, 0), leaf_at(0, 0), leaf_at(6, 0), leaf_at(30, 0)};
  leaves[2].part = leaves[3].part = 1;
  leaves[4].part = 2;
  const auto order = tree_order(leaves);
  EXPECT_EQ(order, (std::vector<std::uint32_t>{1, 0, 2, 3, 4}));
  std::vector<TreeLeaf> ordered;
  for (const auto i : order) ordered.push_back(leaves[i]);
  ClusterTree tree;
  append_tree(ordered, 0, tree);
  ASSERT_EQ(tree.roots.size(), 1u);
  // After part 0 lie 2 m2 of 5, after part 1 more than half.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> inner;
  for (const TreeNodeRange& node : tree.nodes) {
    if (node.count > 1) inner.emplace_back(node.first, node.count);
  }
  EXPECT_EQ(inner, (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 5}, {0, 4}, {0, 2}, {2, 2}}));
}

TEST(Cut, RefinesWhereTheRowSeesAPartAndKeepsWhatItSeesEvenly) {
  const ClusterTree tree = tree_of_eight();
  // The left half evenly; of the right half, one leaf.
  const FormFactorRow row{{0, 1, 2, 3, 6}, {0.1f, 0.1f, 0.1f, 0.1f, 0.3f}};
  const FormFactorRow* rows[] = {&row};
  const CutTile tile = cut_tile(tree, kOnes, rows, kManyRays, {2, 0.0});
  const auto two = ranges(tree, tile);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].count, 4u);
  EXPECT_EQ(two[1].count, 4u);
  EXPECT_FLOAT_EQ(tile.values[0][0], 0.4f);
  EXPECT_FLOAT_EQ(tile.values[0][1], 0.3f);
  // 0.3 stands on four leaves: |0.3 - 0.075| + 3 * 0.075.
  EXPECT_NEAR(tile.spread, 0.45, 1e-3);

  // With room for more, only the right half is taken apart, and what nobody sees is dropped.
  const auto more = ranges(tree, cut_tile(tree, kOnes, rows, kManyRays, {5, 0.0}));
  ASSERT_EQ(more.size(), 2u);
  EXPECT_EQ(more[0].count, 4u);
  EXPECT_EQ(more[1].first, 6u);
  EXPECT_EQ(more[1].count, 1u);
}

TEST(Cut, KeepsAllRootsWhateverTheBudget) {
  const ClusterTree tree = tree_of_eight(4);
  const FormFactorRow row{{0, 2, 4, 6}, {0.1f, 0.2f, 0.3f, 0.4f}};
  const FormFactorRow* rows[] = {&row};
  EXPECT_EQ(cut_tile(tree, kOnes, rows, kManyRays, {1, 0.0}).nodes.size(), 4u);
}

TEST(Cut, RowsOfATileShareNodesAndKeepTheirOwnSums) {
  const ClusterTree tree = tree_of_eight();
  const FormFactorRow a{{0, 1}, {0.5f, 0.25f}}, b{{1, 7}, {0.125f, 0.5f}};
  const FormFactorRow* rows[] = {&a, &b};
  const CutTile tile = cut_tile(tree, kOnes, rows, kManyRays, {100, 0.0});
  EXPECT_EQ(tile.values.size(), 2u);
  float first = 0.0f, second = 0.0f;
  for (const float value : tile.values[0]) first += value;
  for (const float value : tile.values[1]) second += value;
  EXPECT_FLOAT_EQ(first, 0.75f);
  EXPECT_FLOAT_EQ(second, 0.625f);
  ASSERT_EQ(tile.nodes.size(), 3u) << "leaves 0, 1 and 7";
  EXPECT_EQ(tile.values[0][2], 0.0f);
}

TEST(Cut, DoesNotRefineForNoise) {
  const ClusterTree tree = tree_of_eight();
  // Eight rays over eight leaves, as chance has it.
  const FormFactorRow row{{0, 2, 3, 5, 6}, {0.125f, 0.25f, 0.125f, 0.375f, 0.125f}};
  const FormFactorRow* rows[] = {&row};
  // It deviates by 0.75; chance alone makes that much, so that a quarter of it counts.
  EXPECT_EQ(cut_tile(tree, kOnes, rows, 8, {0, 0.2}).nodes.size(), 1u);
  EXPECT_GT(cut_tile(tree, kOnes, rows, kManyRays, {0, 0.2}).nodes.size(), 2u);
  EXPECT_EQ(cut_tile(tree, kOnes, rows, 8, {100, 0.0}).nodes.size(), 5u) << "a budget is used";
}

TEST(CoarsenImports, JoinsWhatWeighsLeastUntilTheRestFits) {
  // Leaves 0 to 7 are all kept; the left half weighs little, most of it in the first quarter.
  const ClusterTree tree = tree_of_eight();
  const std::vector<double> leaf{0.3, 0.2, 0.05, 0.05, 1.0, 1.0, 1.0, 6.4};
  std::vector<double> weight(tree.nodes.size(), -1.0);
  for (std::size_t n = 0; n < weight.size(); ++n) {
    if (tree.nodes[n].count == 1) weight[n] = leaf[tree.nodes[n].first];
  }
  const auto left = [&](std::size_t limit) {
    const CoarserImports coarser = coarsen_imports(tree, weight, limit);
    std::set<std::pair<std::uint32_t, std::uint32_t>> nodes;
    for (std::size_t n = 0; n < weight.size(); ++n) {
      const TreeNodeRange& node = tree.nodes[coarser.node[n]];
      if (weight[n] >= 0.0) nodes.insert({node.first, node.count});
    }
    EXPECT_EQ(nodes.size(), coarser.count);
    return std::pair(nodes, coarser.coarsened_share);
  };
  using Nodes = std::set<std::pair<std::uint32_t, std::uint32_t>>;
  EXPECT_EQ(left(8).first, (Nodes{{0, 1}, {1, 1}, {2, 1}, {3, 1}, {4, 1}, {5, 1}, {6, 1}, {7, 1}}));
  EXPECT_EQ(left(8).second, 0.0);
  EXPECT_EQ(left(7).first, (Nodes{{0, 1}, {1, 1}, {2, 2}, {4, 1}, {5, 1}, {6, 1}, {7, 1}}));
  EXPECT_NEAR(left(7).second, 0.01, 1e-12) << "0.1 of 10";
  EXPECT_EQ(left(6).first, (Nodes{{0, 2}, {2, 2}, {4, 1}, {5, 1}, {6, 1}, {7, 1}}));
  EXPECT_EQ(left(5).first, (Nodes{{0, 4}, {4, 1}, {5, 1}, {6, 1}, {7, 1}}));
  EXPECT_EQ(left(1).first, (Nodes{{0, 8}}));
}

TEST(CoarsenImports, CannotGoAboveRoots) {
  const ClusterTree tree = tree_of_eight(4);
  const CoarserImports coarser = coarsen_imports(tree, std::vector<double>(tree.nodes.size(), 1.0), 3);
  EXPECT_EQ(coarser.count, 4u);
}

TEST(SensorSystems, AreThoseThatTheySeeMostOf) {
  SenderTree senders;
  senders.places = {{0, 0}, {1, 0}, {1, 1}, {kSkySystem, 0}};
  const std::vector<FormFactorRow> rows{
      {{0, 1, 2}, {0.3f, 0.2f, 0.2f}}, {{0, 1, 3}, {0.3f, 0.2f, 0.5f}}, {{3}, {1.0f}}, {{}, {}}};
  EXPECT_EQ(systems_of_sensors(senders, 2, rows), (std::vector<std::uint32_t>{1, 0, 0, 0}));
}

TEST(CutRows, MakesTilesOfNeighboursWithTheRestInTheLast) {
  SenderTree senders;
  senders.tree = tree_of_eight();
  senders.weights = kOnes;
  const FormFactorRow left{{0, 1}, {0.5f, 0.25f}}, right{{7}, {0.5f}};
  const std::vector<const FormFactorRow*> rows{&left, &left, &right};
  const auto tiles = cut_rows(senders, rows, {2, 100, kManyRays});
  ASSERT_EQ(tiles.size(), 2u);
  EXPECT_EQ(tiles[0].values.size(), 2u);
  EXPECT_EQ(tiles[1].values, (std::vector<std::vector<float>>{{0.5f}}));
}

}  // namespace
}  // namespace relume::test
