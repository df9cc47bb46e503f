// SPDX-License-Identifier: MIT
//
// What the leaves of a node count for in its mean.
//
// A mean by area loses light: bright surface is mostly open surface, of which far rows see more for its area
// than of the dark corners in the same node; the rows in the corners, for which the mean would be too bright,
// are near and refine it. With shares w_j in proportion to the light that the rows receive from leaf j by way
// of the node, sum_i A_i F_ij over the rows i that keep it, these rows together receive what the leaves send,
// whatever their radiosities: sum_i A_i F_in sum_j w_j b_j = sum_j b_j sum_i A_i F_ij.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "precompute/cluster_tree.h"

namespace relume {

class NodeFlux {
 public:
  /// Borrows the tree. `receiver_area`: m2, of all rows that will be added, or more.
  NodeFlux(const ClusterTree& tree, double receiver_area);

  /// `flux` (m2: area x form factor) from `leaf` to rows that keep `node`, an inner one. Safe from many
  /// threads; the sum is the same in any order.
  void add(std::uint32_t node, std::uint32_t leaf, double flux);

  /// Per leaf of the node; where no row has kept it, what the nodes below it have. m2.
  std::vector<double> of(std::uint32_t node) const;

 private:
  bool collect(std::uint32_t node, std::uint32_t first_leaf, std::vector<double>& sums) const;

  const ClusterTree& tree_;
  double unit_ = 1.0;                 ///< m2 of one count
  std::vector<std::uint64_t> first_;  ///< per node: in counts_
  std::vector<std::atomic<std::uint64_t>> counts_;
};

}  // namespace relume
