// SPDX-License-Identifier: MIT
//
// The cut: which nodes of the cluster tree a tile of neighbouring rows keeps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/cluster_tree.h"
#include "precompute/row_tracer.h"

namespace relume {

/// Rows of a tile that share one column list.
struct CutTile {
  std::vector<std::uint32_t> nodes;  ///< of ClusterTree, ascending by first leaf, disjoint; their leaves hold
                                     ///< every form factor of the rows
  std::vector<std::vector<float>>
      values;           ///< [row][node]: sum of the row's form factors over the leaves of the node
  float spread = 0.0f;  ///< of all kept nodes: what the cut approximates, as a share of the hemisphere
};

struct CutLimits {
  std::uint32_t budget = 0;  ///< nodes per tile; 0 = as many as the error asks for. A tile that sees more
                             ///< roots than this keeps its roots.
  double error = 0.0;  ///< refine until no node's spread is larger than this share of the rows' mean sum
};

/// Starts from the roots and refines the node of largest spread. The spread of a node n is sum_j |F_j - F_n
/// A_j / A_n| over its leaves j, F the mean of the tile's rows, less what sampling noise alone would make of
/// it with `rays` rays a row, but at least a quarter of it: it is large where the tile sees only a part of
/// the node (through a door, past a wall) and where the node is near. `leaf_area` per leaf.
CutTile cut_tile(const ClusterTree& tree, std::span<const double> leaf_area,
                 std::span<const FormFactorRow* const> rows, std::uint32_t rays, const CutLimits& limits);

}  // namespace relume
