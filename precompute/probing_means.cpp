// SPDX-License-Identifier: MIT
#include "precompute/probing_means.h"

#include <algorithm>

namespace relume {

std::vector<ProbingValues> node_means(const SenderTree& senders, const std::vector<ProbingValues>& values) {
  const ClusterTree& tree = senders.tree;
  std::vector<ProbingValues> means(tree.nodes.size());
  std::vector<double> weights(tree.nodes.size());
  // Children stand after their parents.
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {
    const TreeNodeRange& node = tree.nodes[n];
    if (node.count == 1) {
      means[n] = values[node.first];
      weights[n] = senders.weights[node.first];
      continue;
    }
    weights[n] = weights[node.left] + weights[node.left + 1];
    const auto share = float(weights[node.left] / weights[n]);
    for (std::size_t p = 0; p < kProbings; ++p)
      means[n][p] = share * means[node.left][p] + (1.0f - share) * means[node.left + 1][p];
  }
  return means;
}

std::vector<ProbingValues> coarser(const SenderTree& senders, std::size_t clusters,
                                   const std::vector<ProbingValues>& values) {
  constexpr std::uint32_t kOfTwiceTheSize = 4;
  const ClusterTree& tree = senders.tree;
  const std::vector<ProbingValues> means = node_means(senders, values);
  std::vector<ProbingValues> result = values;
  std::vector<std::uint32_t> open = tree.roots;
  while (!open.empty()) {
    const TreeNodeRange node = tree.nodes[open.back()];
    const ProbingValues& mean = means[open.back()];
    open.pop_back();
    if (node.first >= clusters) continue;
    if (node.count > kOfTwiceTheSize) {
      open.insert(open.end(), {node.left, node.left + 1});
    } else {
      std::fill_n(result.begin() + node.first, node.count, mean);
    }
  }
  return result;
}

}  // namespace relume
