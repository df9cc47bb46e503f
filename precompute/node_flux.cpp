// SPDX-License-Identifier: MIT
#include "precompute/node_flux.h"

#include <cmath>

namespace relume {
namespace {

/// All rows, of clusters and of lumels, together come to less.
constexpr double kMostCounts = 0x1p62;

}  // namespace

NodeFlux::NodeFlux(const ClusterTree& tree, double receiver_area)
    : tree_(tree), unit_(receiver_area / kMostCounts) {
  std::uint64_t next = 0;
  for (const TreeNodeRange& node : tree.nodes) {
    first_.push_back(next);
    if (node.count > 1) next += node.count;
  }
  counts_ = std::vector<std::atomic<std::uint64_t>>(next);
}

void NodeFlux::add(std::uint32_t node, std::uint32_t leaf, double flux) {
  const auto count = static_cast<std::uint64_t>(std::llround(flux / unit_));
  counts_[first_[node] + leaf - tree_.nodes[node].first].fetch_add(count, std::memory_order_relaxed);
}

bool NodeFlux::collect(std::uint32_t node, std::uint32_t first_leaf, std::vector<double>& sums) const {
  const TreeNodeRange& range = tree_.nodes[node];
  if (range.count < 2) return false;
  bool any = false;
  for (std::uint32_t i = 0; i < range.count; ++i) {
    const double flux = unit_ * double(counts_[first_[node] + i].load(std::memory_order_relaxed));
    sums[range.first - first_leaf + i] += flux;
    any = any || flux > 0.0;
  }
  return any;
}

std::vector<double> NodeFlux::of(std::uint32_t node) const {
  std::vector<double> sums(tree_.nodes[node].count, 0.0);
  std::vector<std::uint32_t> open{node};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    if (collect(at, tree_.nodes[node].first, sums) || tree_.nodes[at].count < 2) continue;
    open.insert(open.end(), {tree_.nodes[at].left, tree_.nodes[at].left + 1});
  }
  return sums;
}

}  // namespace relume
