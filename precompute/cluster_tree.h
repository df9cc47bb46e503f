// SPDX-License-Identifier: MIT
//
// The cluster tree: binary trees over clusters whose numbers run in tree order, so that every node is a range
// of numbers.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace relume {

/// What the tree asks of a leaf.
struct TreeLeaf {
  glm::vec3 centroid{0.0f};
  glm::vec3 normal{0.0f};
  float area = 0.0f;        ///< m2, or steradian for sky patches
  std::uint32_t group = 0;  ///< leaves of different groups never share a node
  std::uint32_t part = 0;   ///< system: a node lies inside one part of its group, or holds whole parts
};

/// A node is the leaves [first, first + count).
struct TreeNodeRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::uint32_t left = 0;  ///< index of the left child; the right one follows it. Unused by leaves (count 1).
};

struct ClusterTree {
  std::vector<TreeNodeRange> nodes;  ///< children after their parents
  std::vector<std::uint32_t> roots;  ///< one per group and call of append_tree
};

/// Appends the tree over `leaves` and returns the order in which every node is a range: leaf `order[i]`
/// becomes number `first` + i. Groups follow each other; inside, a set is cut in two across the direction in
/// which it is longest, where normals count as a little further apart than the set is wide: by area, at the
/// beginning of a tile of rows (kTileRows leaves of a part), or in the widest gap between normals. So the
/// rows of a tile see much the same, and nodes are of surfaces that are lit alike. A set of several parts is
/// halved between parts, along the axis in which their centroids lie widest.
std::vector<std::uint32_t> append_tree(const std::vector<TreeLeaf>& leaves, std::uint32_t first,
                                       ClusterTree& tree);

}  // namespace relume
