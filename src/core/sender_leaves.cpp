// SPDX-License-Identifier: MIT
#include "core/sender_leaves.h"

#include "core/sky.h"

namespace relume {

LeafNumbers::LeafNumbers(const Model& model) : model_(model), first_cluster_(cluster_offsets(model)) {
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) weights_.push_back(cluster.area);
  }
  for (const std::uint32_t cell : model.sky_cells)
    weights_.push_back(sky_cell_solid_angle(cell, model.sky_resolution));
}

LeafRange LeafNumbers::range_in_system(const SenderRef& sender) const {
  const bool sky = sender.system == kSkySystem;
  const std::uint32_t first = sky ? first_cluster_.back() : first_cluster_[sender.system];
  const std::size_t leaves = sky ? model_.sky_cells.size() : model_.systems[sender.system].clusters.size();
  if (sender.index < leaves) return {first + sender.index, 1};
  const TreeNode& node = (sky ? model_.sky_tree : model_.systems[sender.system].tree)[sender.index - leaves];
  return {first + node.first, node.count};
}

SenderLeaves LeafNumbers::leaves_of(const SenderRef& sender) const {
  SenderLeaves leaves;
  const auto add = [&](const SenderRef& part, double area) {
    if (part.system == kSkySystem || model_.systems[part.system].loaded) {
      leaves.ranges.push_back(range_in_system(part));
    } else {
      leaves.missing_area += area;
    }
  };
  if (sender.system != kSpanningNodes) {
    add(sender, 0.0);
    return leaves;
  }
  const SpanningNode& node = model_.top_tree[sender.index];
  for (std::uint32_t p = node.first_part; p < node.first_part + node.part_count; ++p)
    add(model_.top_parts[p].sender, model_.top_parts[p].area);
  return leaves;
}

double LeafNumbers::weight_of(const SenderLeaves& leaves) const {
  double sum = leaves.missing_area;
  for (const LeafRange& range : leaves.ranges) {
    for (std::uint32_t leaf = range.first; leaf < range.first + range.count; ++leaf) sum += weights_[leaf];
  }
  return sum;
}

double LeafNumbers::missing_share(const SenderLeaves& leaves) const {
  if (leaves.ranges.empty()) return 1.0;
  return leaves.missing_area > 0.0 ? leaves.missing_area / weight_of(leaves) : 0.0;
}

}  // namespace relume
