// SPDX-License-Identifier: MIT
#include "compute/node_tables.h"

#include <gmock/gmock.h>

#include <bit>

#include "kernels/shared/limits.h"

namespace relume {
namespace {

using testing::ElementsAre;

struct Part {
  std::uint32_t sender;
  float share;
  friend bool operator==(const Part&, const Part&) = default;
};

std::vector<Part> parts_of(const NodeTables& tables, std::size_t record) {
  std::vector<Part> parts;
  const kernels::uvec4& node = tables.records[record];
  for (std::uint32_t p = node.x; p < node.x + node.y; ++p)
    parts.push_back({tables.parts[p][0], std::bit_cast<float>(tables.parts[p][1])});
  return parts;
}

/// Node 0 over leaves 0 to 9, node 1 over 1 and 2, node 2 over 1 to 8, whose areas are 1, 1, 1, 5, 1, ...
ClusterTreeNodes three_nodes(float share_of_leaf_1) {
  ClusterTreeNodes tree{{{0, 10, 0}, {1, 2, 10}, {1, 8, 12}}, std::vector<float>(20, 0.0f)};
  constexpr float kArea[] = {1, 1, 1, 5, 1, 1, 1, 1, 1, 3};
  for (int i = 0; i < 10; ++i) tree.shares[i] = kArea[i] / 16.0f;
  tree.shares[10] = tree.shares[11] = 0.5f;
  for (int i = 1; i < 9; ++i) tree.shares[11 + i] = kArea[i] / 12.0f;
  tree.shares[12] = share_of_leaf_1;
  return tree;
}

TEST(NodeTables, ALargeNodeIsMadeOfTheLargestSmallOnesInIt) {
  const NodeTables tables = node_tables(three_nodes(1.0f / 12.0f), 10);
  ASSERT_EQ(tables.records.size(), 3u);
  EXPECT_EQ(tables.small, 2u);
  EXPECT_EQ(tables.records[0].z, 11u);
  EXPECT_THAT(parts_of(tables, 0), ElementsAre(Part{1, 0.5f}, Part{2, 0.5f}));
  EXPECT_EQ(tables.records[1].z, 12u);
  EXPECT_EQ(tables.records[1].y, 8u);
  EXPECT_EQ(tables.records[2].z, 10u);
  EXPECT_THAT(parts_of(tables, 2),
              ElementsAre(Part{0, 1.0f / 16.0f}, Part{12, 12.0f / 16.0f}, Part{9, 3.0f / 16.0f}));
}

TEST(NodeTables, SharesThatAreNotInProportionAreKeptLeafByLeaf) {
  ClusterTreeNodes tree = three_nodes(0.25f);
  tree.shares[14] -= 0.25f - 1.0f / 12.0f;
  const NodeTables tables = node_tables(tree, 10);
  EXPECT_EQ(tables.records[2].y, 10u);
  EXPECT_EQ(parts_of(tables, 2)[1], (Part{1, 1.0f / 16.0f}));
  EXPECT_EQ(parts_of(tables, 2)[3], (Part{3, 5.0f / 16.0f}));
}

TEST(NodeTables, ATreeWithoutNodesHasNone) {
  const NodeTables tables = node_tables({}, 4);
  EXPECT_TRUE(tables.records.empty() && tables.parts.empty());
}

}  // namespace
}  // namespace relume
