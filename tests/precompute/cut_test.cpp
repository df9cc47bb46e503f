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

std::vector<TreeNodeRange> ranges(const ClusterTree& tree, const CutTile& tile) {
  std::vector<TreeNodeRange> result;
  for (const auto node : tile.nodes) result.push_back(tree.nodes[node]);
  return result;
}

TEST(ClusterTree, OrdersByGroupThenAlongTheLongestDirection) {
  ClusterTree tree;
  const auto order =
      append_tree({leaf_at(3, 1), leaf_at(1, 0), leaf_at(0, 1), leaf_at(0, 0), leaf_at(2, 1)}, 0, tree);
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

TEST(ClusterTree, SurfacesAtRightAnglesPartBeforeTheyAreHalved) {
  // A floor of 12 m and a wall of 4 m at its end: by area, half of the floor would go with the wall.
  std::vector<TreeLeaf> leaves;
  for (int i = 0; i < 12; ++i) leaves.push_back(leaf_at(float(i), 0));
  for (int i = 0; i < 4; ++i) leaves.push_back({{11.5f, 0.5f + float(i), 0}, {-1, 0, 0}, 1.0f, 0});
  ClusterTree tree;
  const auto order = append_tree(leaves, 0, tree);
  const TreeNodeRange& left = tree.nodes[tree.nodes[0].left];
  EXPECT_EQ(left.count, 4u);
  for (std::uint32_t i = 0; i < left.count; ++i) EXPECT_EQ(leaves[order[i]].normal.x, -1.0f);
}

TEST(ClusterTree, HalvesWhereATileOfRowsBegins) {
  std::vector<TreeLeaf> leaves;
  for (int i = 0; i < 21; ++i) leaves.push_back(leaf_at(float(i), 0));
  ClusterTree tree;
  append_tree(leaves, 0, tree);
  // Half of the area ends after leaf 10; then half of 8 leaves, and of 13, of which a tile begins after 8.
  const TreeNodeRange& left = tree.nodes[tree.nodes[0].left];
  EXPECT_EQ(left.count, 8u);
  EXPECT_EQ(tree.nodes[left.left].count, 4u);
  EXPECT_EQ(tree.nodes[tree.nodes[tree.nodes[0].left + 1].left].count, 8u);
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
  ClusterTree tree;
  EXPECT_EQ(append_tree(leaves, 0, tree), (std::vector<std::uint32_t>{1, 0, 2, 3, 4}));
  ASSERT_EQ(tree.roots.size(), 1u);
  // After part 0 lie 2 m2 of 5, after part 1 more than half.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> inner;
  for (const TreeNodeRange& node : tree.nodes) {
    if (node.count > 1) inner.emplace_back(node.first, node.count);
  }
  EXPECT_EQ(inner, (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 5}, {0, 4}, {0, 2}, {2, 2}}));
}

/// Every probe shows the leaves of the tree with these radiosities, in one room of irradiance 1.
Probing shown(const ClusterTree& tree, const std::vector<float>& radiosities) {
  Probing probing;
  for (const float radiosity : radiosities) {
    probing.senders.emplace_back().fill(radiosity);
    probing.rooms.push_back(0);
  }
  for (const TreeNodeRange& node : tree.nodes) {
    float sum = 0.0f;
    for (std::uint32_t i = 0; i < node.count; ++i) sum += radiosities[node.first + i];
    probing.nodes.emplace_back().fill(sum / float(node.count));
  }
  probing.weights.emplace_back().fill(1.0f);
  probing.surfaces.resize(tree.nodes.size());
  return probing;
}

/// Without noise.
constexpr float kManyRays = 1e9f;

CutTile cut(const ClusterTree& tree, const Probing& probing, const std::vector<const FormFactorRow*>& rows,
            const CutLimits& limits) {
  std::vector<CutRow> tile;
  for (const FormFactorRow* row : rows) tile.push_back({row, kManyRays, 0.0f, {}});
  return TileCutter({tree, probing}).cut(tile, limits);
}

const std::vector<float> kRamp{1, 2, 3, 4, 5, 6, 7, 8};

TEST(Cut, RefinesWhereMeansMisleadAndKeepsWhatLooksAlike) {
  const ClusterTree tree = tree_of_eight();
  // The left half looks alike; of the right half the row sees one leaf, which differs from the mean.
  const Probing probing = shown(tree, {1, 1, 1, 1, 5, 6, 9, 8});
  const FormFactorRow row{{0, 1, 2, 3, 6}, {0.25f, 0.125f, 0.0625f, 0.0625f, 0.25f}};
  const CutTile two = cut(tree, probing, {&row}, {2, 0.0});
  ASSERT_EQ(two.nodes.size(), 2u);
  EXPECT_EQ(ranges(tree, two)[0].count, 4u);
  EXPECT_FLOAT_EQ(two.values[0][0], 0.5f);
  EXPECT_FLOAT_EQ(two.values[0][1], 0.25f);
  // The mean of 5, 6, 9 and 8 is 7 where the row sees 9.
  EXPECT_NEAR(two.error[0], 0.25 * 2.0, 1e-6);

  // With room for more, only the right half is taken apart, and what nobody sees is dropped.
  const auto more = ranges(tree, cut(tree, probing, {&row}, {5, 0.0}));
  ASSERT_EQ(more.size(), 2u);
  EXPECT_EQ(more[0].count, 4u);
  EXPECT_EQ(more[1].first, 6u);
  EXPECT_EQ(more[1].count, 1u);
}

TEST(Cut, StopsAtTheErrorAskedFor) {
  const ClusterTree tree = tree_of_eight();
  const Probing probing = shown(tree, kRamp);
  const FormFactorRow row{{0, 1, 2, 3, 4, 5, 6, 7}, {0.2f, 0.1f, 0.1f, 0.1f, 0.1f, 0.1f, 0.1f, 0.2f}};
  // Seen evenly but for the ends, which are as far from the mean as each other: one node is right as it is.
  EXPECT_EQ(cut(tree, probing, {&row}, {0, 1e-3}).nodes.size(), 1u);
  // Seen from one end, it is not.
  const FormFactorRow end{{0, 1, 2, 3, 4, 5, 6, 7}, {0.3f, 0.2f, 0.1f, 0.1f, 0.1f, 0.05f, 0.05f, 0.05f}};
  std::size_t before = 1;
  for (const double error : {0.5, 0.1, 0.02, 1e-4}) {
    const CutTile tile = cut(tree, probing, {&end}, {0, error});
    EXPECT_GE(tile.nodes.size(), before);
    before = tile.nodes.size();
  }
  EXPECT_GT(before, 4u);
}

TEST(Cut, KeepsAllRootsWhateverTheBudget) {
  const ClusterTree tree = tree_of_eight(4);
  const FormFactorRow row{{0, 2, 4, 6}, {0.1f, 0.2f, 0.3f, 0.4f}};
  EXPECT_EQ(cut(tree, shown(tree, kRamp), {&row}, {1, 0.0}).nodes.size(), 4u);
}

TEST(Cut, RowsOfATileShareNodesAndKeepTheirOwnSums) {
  const ClusterTree tree = tree_of_eight();
  const FormFactorRow a{{0, 1}, {0.5f, 0.25f}}, b{{1, 7}, {0.125f, 0.5f}};
  const CutTile tile = cut(tree, shown(tree, {1, 9, 2, 2, 2, 2, 2, 9}), {&a, &b}, {100, 0.0});
  EXPECT_EQ(tile.values.size(), 2u);
  float first = 0.0f, second = 0.0f;
  for (const float value : tile.values[0]) first += value;
  for (const float value : tile.values[1]) second += value;
  EXPECT_FLOAT_EQ(first, 0.75f);
  EXPECT_FLOAT_EQ(second, 0.625f);
  ASSERT_EQ(tile.nodes.size(), 3u) << "leaves 0, 1 and 7";
  EXPECT_EQ(tile.values[0][2], 0.0f);
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

/// Eight of 1 m2 side by side on the floor, all of one radiosity.
Probing patches_in_a_row(const ClusterTree& tree) {
  Probing probing = shown(tree, std::vector<float>(8, 1.0f));
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    const TreeNodeRange& node = tree.nodes[n];
    const float middle = float(node.first) + 0.5f * float(node.count - 1);
    probing.surfaces[n] = {float(node.count), 8.0f, {middle, 0, 0}, {0, 1, 0}};
  }
  return probing;
}

// Such patches, seen from 1 m above the first: but a light may come that shines on one of them.
TEST(Cut, RefinesNearbyWhereASpotMightShineThoughAllLooksAlike) {
  const ClusterTree tree = tree_of_eight();
  const Probing probing = patches_in_a_row(tree);
  FormFactorRow row;
  for (std::uint32_t i = 0; i < 8; ++i) {
    row.senders.push_back(i);
    row.values.push_back(float(1.0 / (3.2 * (1.0 + i * i) * (1.0 + i * i))));
  }
  const CutTile tile =
      TileCutter({tree, probing})
          .cut(std::vector<CutRow>{{&row, kManyRays, 0.0f, {{0, 1, 0}, {0, -1, 0}}}}, {4, 0.0});
  std::vector<std::uint32_t> counts;
  for (const TreeNodeRange& node : ranges(tree, tile)) counts.push_back(node.count);
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{1, 1, 2, 4}));
}

// The same patches: four in the room of the row, four in another, of which it sees a fifth. By hand, what
// their node hides of a spot there is 0.1 x 0.2 x 1.885 = 0.0377 of the light in that room, of which this one
// gets a share that counts as a tenth at least.
TEST(Cut, RefinesWhatLightsADimRoomForLightsThatNoProbingKnows) {
  const ClusterTree tree = tree_of_eight(2);
  Probing probing = patches_in_a_row(tree);
  probing.rooms = {0, 0, 0, 0, 1, 1, 1, 1};
  probing.weights.resize(2, probing.weights[0]);
  probing.lit = {{0, 1}, probing.weights, {}};
  const FormFactorRow row{{0, 4, 5, 6, 7}, {0.6f, 0.1f, 0.05f, 0.03f, 0.02f}};
  const std::vector<CutRow> tile{{&row, kManyRays, 0.0f, {{4, 1, 0}, {0, -1, 0}}}};
  const auto nodes_there = [&](float share, double error) {
    probing.lit.shares = {1.0f, share, share, 1.0f};
    const CutTile cut = TileCutter({tree, probing}).cut(tile, {0, error});
    const auto kept = ranges(tree, cut);
    return std::count_if(kept.begin(), kept.end(), [](const TreeNodeRange& node) { return node.first >= 4; });
  };
  EXPECT_EQ(nodes_there(0.38f, 0.1), 1);
  EXPECT_GT(nodes_there(0.37f, 0.1), 1);
  EXPECT_EQ(nodes_there(0.001f, 0.38), 1);
  EXPECT_GT(nodes_there(0.001f, 0.37), 1);
}

// A row that sees the brighter half of a node through a door is off by 0.4 x 0.5 = 0.2, relative to its own
// room under that light, and by 0.4 where that gets half of what the node's room gets while it alone is lit.
TEST(Cut, CountsWhatANodeInAnotherRoomHidesAsIfThatAloneWereLit) {
  const ClusterTree tree = tree_of_eight(2);
  Probing probing = shown(tree, {1, 1, 1, 1, 1, 1, 2, 2});
  probing.rooms = {0, 0, 0, 0, 1, 1, 1, 1};
  probing.weights.resize(2, probing.weights[0]);
  const FormFactorRow row{{0, 6, 7}, {0.6f, 0.2f, 0.2f}};
  const auto leaves_there = [&](double error) {
    return ranges(tree, cut(tree, probing, {&row}, {0, error})).back().count;
  };
  EXPECT_EQ(leaves_there(0.21), 4u);
  EXPECT_EQ(leaves_there(0.19), 2u);
  probing.lit = {{0, 1}, probing.weights, {1.0f, 0.5f, 0.5f, 1.0f}};
  EXPECT_EQ(leaves_there(0.41), 4u);
  EXPECT_EQ(leaves_there(0.39), 2u);
}

// From above the middle of four patches, of which only the first is seen: by a thousand million rays, or by
// 19, of whose two hits no half can be told from the other.
TEST(Cut, RefinesWhatIsSeenInPartForASpotUnlessRaysAreTooFewToTell) {
  const ClusterTree tree = tree_of_eight();
  const Probing probing = patches_in_a_row(tree);
  const FormFactorRow row{{4}, {0.1f}};
  const auto leaves_of = [&](float rays) {
    const CutTile tile =
        TileCutter({tree, probing})
            .cut(std::vector<CutRow>{{&row, rays, 0.0f, {{5.5f, 1, 0}, {0, -1, 0}}}}, {8, 0.0});
    return ranges(tree, tile).front().count;
  };
  EXPECT_EQ(leaves_of(kManyRays), 1u);
  EXPECT_EQ(leaves_of(19.0f), 4u);
}

// Rows of 2 m2 and 1 m2 that keep the root: 2 x 0.5 = 1 m2 from leaf 0, 2 x 0.25 + 0.5 = 1 m2 from leaf 1,
// 0.25 from leaf 7.
TEST(NodeFlux, IsWhatTheRowsReceiveFromEachLeafByWayOfTheNode) {
  const ClusterTree tree = tree_of_eight();
  const Probing probing = shown(tree, std::vector<float>(8, 1.0f));
  NodeFlux flux(tree, 3.0);
  const FormFactorRow large{{0, 1}, {0.5f, 0.25f}}, small{{1, 7}, {0.5f, 0.25f}};
  TileCutter({tree, probing, &flux})
      .cut(std::vector<CutRow>{{&large, kManyRays, 2.0f, {}}, {&small, kManyRays, 1.0f, {}}}, {1, 0.0});
  const std::vector<double> of_root = flux.of(tree.roots[0]);
  ASSERT_EQ(of_root.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(of_root[i], i < 2 ? 1.0 : i == 7 ? 0.25 : 0.0, 1e-15) << i;
  const std::vector<double> below = flux.of(tree.nodes[tree.roots[0]].left);
  EXPECT_EQ(below, std::vector<double>(4, 0.0)) << "no row keeps a node below";
}

// Nobody keeps the root, but its halves.
TEST(NodeFlux, OfANodeThatNoRowKeepsIsThatOfTheNodesBelow) {
  const ClusterTree tree = tree_of_eight();
  const Probing probing = shown(tree, {1, 1, 1, 1, 5, 5, 5, 5});
  NodeFlux flux(tree, 1.0);
  const FormFactorRow row{{0, 5}, {0.5f, 0.25f}};
  TileCutter({tree, probing, &flux}).cut(std::vector<CutRow>{{&row, kManyRays, 1.0f, {}}}, {2, 0.0});
  const std::vector<double> of_root = flux.of(tree.roots[0]);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(of_root[i], i == 0 ? 0.5 : i == 5 ? 0.25 : 0.0, 1e-15) << i;
}

TEST(SensorSystems, AreThoseThatTheySeeMostOf) {
  SenderTree senders;
  senders.places = {{0, 0}, {1, 0}, {1, 1}, {kSkySystem, 0}};
  const std::vector<FormFactorRow> rows{
      {{0, 1, 2}, {0.3f, 0.2f, 0.2f}}, {{0, 1, 3}, {0.3f, 0.2f, 0.5f}}, {{3}, {1.0f}}, {{}, {}}};
  EXPECT_EQ(systems_of_sensors(senders, 2, rows), (std::vector<std::uint32_t>{1, 0, 0, 0}));
}

TEST(CutRows, MakesTilesOfNeighboursWithTheRestInTheLast) {
  const ClusterTree tree = tree_of_eight();
  const FormFactorRow left{{0, 1}, {0.5f, 0.25f}}, right{{7}, {0.5f}};
  std::vector<CutRow> rows;
  for (const FormFactorRow* row : {&left, &left, &right}) rows.push_back({row, kManyRays, 0.0f, {}});
  const CutLimits limits{100, 0.0};
  const Probing probing = shown(tree, kRamp);
  const auto tiles = cut_rows({tree, probing}, rows, {2, {&limits, 1}});
  ASSERT_EQ(tiles.size(), 2u);
  EXPECT_EQ(tiles[0].values.size(), 2u);
  EXPECT_EQ(tiles[1].values, (std::vector<std::vector<float>>{{0.5f}}));
}

}  // namespace
}  // namespace relume::test
