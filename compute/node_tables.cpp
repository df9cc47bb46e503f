// SPDX-License-Identifier: MIT
#include "compute/node_tables.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

#include "kernels/shared/limits.h"

namespace relume {
namespace {

/// Shares are rounded to floats: in proportion is what differs by less, relative.
constexpr double kProportional = 1e-6;

class TableMaker {
 public:
  TableMaker(const ClusterTreeNodes& tree, std::uint32_t leaves) : tree_(tree), leaves_(leaves) {
    tables_.records.reserve(tree.nodes.size());
  }

  NodeTables make() && {
    std::vector<std::uint32_t> order(tree_.nodes.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::min(tree_.nodes[a].count, kernels::kSmallNode + 1) <
             std::min(tree_.nodes[b].count, kernels::kSmallNode + 1);
    });
    largest_at_.assign(leaves_, kNone);
    for (const std::uint32_t node : order) add(node);
    return std::move(tables_);
  }

 private:
  std::span<const float> shares(const TreeNode& node) const {
    return std::span(tree_.shares).subspan(node.first_share, node.count);
  }

  void add_part(std::uint32_t sender, double share) {
    tables_.parts.push_back({sender, std::bit_cast<kernels::uint>(static_cast<float>(share))});
  }

  void add(std::uint32_t index) {
    const TreeNode& node = tree_.nodes[index];
    const auto first = static_cast<kernels::uint>(tables_.parts.size());
    if (node.count <= kernels::kSmallNode) {
      for (std::uint32_t i = 0; i < node.count; ++i) add_part(node.first + i, shares(node)[i]);
      // Small ones come by size, so that the last one that begins with a leaf is the largest.
      largest_at_[node.first] = index;
      ++tables_.small;
    } else {
      for (std::uint32_t i = 0; i < node.count;) i += add_next(node, i);
    }
    const auto count = static_cast<kernels::uint>(tables_.parts.size()) - first;
    tables_.records.push_back({first, count, leaves_ + index, 0});
  }

  /// The part of a large node that begins with its leaf number `i`; gives the number of its leaves.
  std::uint32_t add_next(const TreeNode& node, std::uint32_t i) {
    const std::uint32_t inner = largest_at_[node.first + i];
    if (inner != kNone && tree_.nodes[inner].count <= node.count - i) {
      const std::span<const float> own = shares(tree_.nodes[inner]),
                                   above = shares(node).subspan(i, own.size());
      const double share = std::accumulate(above.begin(), above.end(), 0.0);
      const bool proportional = std::equal(own.begin(), own.end(), above.begin(), [&](double a, double b) {
        return std::abs(share * a - b) <= kProportional * b;
      });
      if (proportional) {
        add_part(leaves_ + inner, share);
        return tree_.nodes[inner].count;
      }
    }
    add_part(node.first + i, shares(node)[i]);
    return 1;
  }

  const ClusterTreeNodes& tree_;
  std::uint32_t leaves_;
  std::vector<std::uint32_t> largest_at_;  ///< per leaf: the largest small node that begins with it
  NodeTables tables_;
};

}  // namespace

NodeTables node_tables(const ClusterTreeNodes& tree, std::uint32_t leaves) {
  return TableMaker(tree, leaves).make();
}

}  // namespace relume
