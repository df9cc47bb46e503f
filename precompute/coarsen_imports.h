// SPDX-License-Identifier: MIT
//
// Fewer senders for a system that sees more than its columns can name.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/model.h"
#include "precompute/cluster_tree.h"

namespace relume {

struct CoarserImports {
  std::vector<std::uint32_t> node;  ///< per node of the tree: the one that stands for it, itself or above it
  std::uint32_t count = 0;          ///< nodes that are left of those with a weight
  double coarsened_share = 0.0;     ///< of all weight: what another node stands for now
};

/// `weight` per node of the tree: sum of the form factors of all rows of the system, negative for nodes that
/// none keeps. Finds the smallest weight such that at most `limit` nodes are left when all nodes below a
/// common one become that one wherever together they weigh no more: what is far goes first. More than `limit`
/// are left when the tree has more roots that are seen.
CoarserImports coarsen_imports(const ClusterTree& tree, std::span<const double> weight, std::size_t limit);

}  // namespace relume
