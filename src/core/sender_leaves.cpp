// SPDX-License-Identifier: MIT
#include "core/sender_leaves.h"

namespace relume {

LeafNumbers::LeafNumbers(const Model& model) : model_(model), first_cluster_(cluster_offsets(model)) {}

std::uint32_t LeafNumbers::count() const {
  return first_cluster_.back() + static_cast<std::uint32_t>(model_.sky_cells.size());
}

LeafRange LeafNumbers::range_in_system(const SenderRef& sender) const {
  const bool sky = sender.system == kSkySystem;
  const std::uint32_t first = sky ? first_cluster_.back() : first_cluster_[sender.system];
  const std::size_t leaves = sky ? model_.sky_cells.size() : model_.systems[sender.system].clusters.size();
  if (sender.index < leaves) return {first + sender.index, 1, 1.0, {}};
  const ClusterTreeNodes& tree = sky ? model_.sky_tree : model_.systems[sender.system].tree;
  const TreeNode& node = tree.nodes[sender.index - leaves];
  return {first + node.first, node.count, 1.0, std::span(tree.shares).subspan(node.first_share, node.count)};
}

SenderLeaves LeafNumbers::leaves_of(const SenderRef& sender) const {
  SenderLeaves leaves;
  const auto add = [&](const SenderRef& part, double share) {
    if (part.system == kSkySystem || model_.systems[part.system].loaded) {
      leaves.ranges.push_back(range_in_system(part));
      leaves.ranges.back().share = share;
    } else {
      leaves.missing_share += share;
    }
  };
  if (sender.system != kSpanningNodes) {
    add(sender, 1.0);
    return leaves;
  }
  const SpanningNode& node = model_.top_tree[sender.index];
  for (std::uint32_t p = node.first_part; p < node.first_part + node.part_count; ++p)
    add(model_.top_parts[p].sender, double(model_.top_parts[p].share));
  return leaves;
}

}  // namespace relume
