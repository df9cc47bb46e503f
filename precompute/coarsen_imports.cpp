// SPDX-License-Identifier: MIT
#include "precompute/coarsen_imports.h"

#include <algorithm>
#include <numeric>

namespace relume {
namespace {

/// Weight of every node and all below it; negative: nothing is kept there.
std::vector<double> subtree_weights(const ClusterTree& tree, std::span<const double> weight) {
  std::vector<double> sums(weight.begin(), weight.end());
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {
    if (tree.nodes[n].count < 2) continue;
    for (const std::uint32_t child : {tree.nodes[n].left, tree.nodes[n].left + 1}) {
      if (sums[child] >= 0.0) sums[n] = std::max(sums[n], 0.0) + sums[child];
    }
  }
  return sums;
}

/// Every node below the highest one whose subtree weighs at most `most` becomes that one.
CoarserImports coarsen_below(const ClusterTree& tree, std::span<const double> weight,
                             std::span<const double> sums, double most) {
  CoarserImports result;
  result.node.resize(tree.nodes.size());
  std::iota(result.node.begin(), result.node.end(), 0u);
  std::vector<bool> kept(tree.nodes.size(), false);
  double total = 0.0;
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    // Children come after their parents.
    const bool collapsed =
        result.node[n] != n || (tree.nodes[n].count > 1 && sums[n] >= 0.0 && sums[n] <= most);
    if (collapsed && tree.nodes[n].count > 1) {
      for (const std::uint32_t child : {tree.nodes[n].left, tree.nodes[n].left + 1})
        result.node[child] = result.node[n];
    }
    if (weight[n] < 0.0) continue;
    total += weight[n];
    if (result.node[n] != n) result.coarsened_share += weight[n];
    if (!kept[result.node[n]]) ++result.count;
    kept[result.node[n]] = true;
  }
  if (total > 0.0) result.coarsened_share /= total;
  return result;
}

}  // namespace

CoarserImports coarsen_imports(const ClusterTree& tree, std::span<const double> weight, std::size_t limit) {
  const std::vector<double> sums = subtree_weights(tree, weight);
  CoarserImports result = coarsen_below(tree, weight, sums, -1.0);
  if (result.count <= limit) return result;
  std::vector<double> steps;
  for (std::size_t n = 0; n < sums.size(); ++n) {
    if (tree.nodes[n].count > 1 && sums[n] >= 0.0) steps.push_back(sums[n]);
  }
  std::sort(steps.begin(), steps.end());
  const auto enough = std::partition_point(steps.begin(), steps.end(), [&](double most) {
    return coarsen_below(tree, weight, sums, most).count > limit;
  });
  if (steps.empty()) return result;
  return coarsen_below(tree, weight, sums, enough == steps.end() ? steps.back() : *enough);
}

}  // namespace relume
