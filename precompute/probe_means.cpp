// SPDX-License-Identifier: MIT
#include "precompute/probe_means.h"

#include <algorithm>

namespace relume {

std::vector<ProbeValues> node_means(const SenderTree& senders, const std::vector<ProbeValues>& values) {
  const ClusterTree& tree = senders.tree;
  std::vector<ProbeValues> means(tree.nodes.size());
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
    for (std::size_t p = 0; p < kProbes; ++p)
      means[n][p] = share * means[node.left][p] + (1.0f - share) * means[node.left + 1][p];
  }
  return means;
}

std::vector<ProbeValues> coarser(const SenderTree& senders, std::size_t clusters,
                                 const std::vector<ProbeValues>& values) {
  constexpr std::uint32_t kOfTwiceTheSize = 4;
  const ClusterTree& tree = senders.tree;
  const std::vector<ProbeValues> means = node_means(senders, values);
  std::vector<ProbeValues> result = values;
  std::vector<std::uint32_t> open = tree.roots;
  while (!open.empty()) {
    const TreeNodeRange node = tree.nodes[open.back()];
    const ProbeValues& mean = means[open.back()];
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
