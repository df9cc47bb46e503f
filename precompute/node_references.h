// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/model.h"
#include "precompute/node_flux.h"
#include "precompute/number_senders.h"

namespace relume {

/// What senders the nodes of the tree are in the model; nodes that no tile keeps have no place there.
class NodeReferences {
 public:
  NodeReferences(const SenderTree& senders, const NodeFlux* flux)
      : senders_(senders), flux_(flux), references_(senders.tree.nodes.size(), {kUnused, 0}) {}

  /// Adds an inner node to the tree of its system, or to the one above the systems, once.
  void use(std::uint32_t node, Model& model) {
    SenderRef& reference = references_[node];
    if (reference.system != kUnused) return;
    const std::vector<double> weights = weights_of(node);
    reference = in_one_system(node) ? inside(senders_.tree.nodes[node], weights, model)
                                    : spanning(node, weights, model);
  }
  const SenderRef& of(std::uint32_t node) const { return references_[node]; }

 private:
  bool in_one_system(std::uint32_t node) const {
    const TreeNodeRange& range = senders_.tree.nodes[node];
    return senders_.places[range.first].system == senders_.places[range.first + range.count - 1].system;
  }

  /// Per leaf; where nothing is known of the light that goes by way of the node, what leaves weigh.
  std::vector<double> weights_of(std::uint32_t node) const {
    const TreeNodeRange& range = senders_.tree.nodes[node];
    std::vector<double> weights;
    if (flux_ != nullptr && range.count > 1) weights = flux_->of(node);
    if (std::accumulate(weights.begin(), weights.end(), 0.0) > 0.0) return weights;
    const auto first = senders_.weights.begin() + std::ptrdiff_t(range.first);
    return {first, first + std::ptrdiff_t(range.count)};
  }

  SenderRef inside(const TreeNodeRange& range, std::span<const double> weights, Model& model) const {
    const SenderRef first = senders_.places[range.first];
    if (range.count == 1) return first;
    const bool sky = first.system == kSkySystem;
    auto& tree = sky ? model.sky_tree : model.systems[first.system].tree;
    const std::size_t leaves = sky ? model.sky_cells.size() : model.systems[first.system].clusters.size();
    tree.nodes.push_back({first.index, range.count, std::uint32_t(tree.shares.size())});
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (const double weight : weights) tree.shares.push_back(float(weight / sum));
    return {first.system, std::uint32_t(leaves + tree.nodes.size() - 1)};
  }

  SenderRef spanning(std::uint32_t node, std::span<const double> weights, Model& model) {
    std::vector<SpannedPart> parts;
    append_parts(node, senders_.tree.nodes[node].first, weights, model, parts);
    double sum = 0.0;
    for (const SpannedPart& part : parts) sum += double(part.share);
    for (SpannedPart& part : parts) part.share = float(double(part.share) / sum);
    std::sort(parts.begin(), parts.end(),
              [](const SpannedPart& a, const SpannedPart& b) { return a.sender.system < b.sender.system; });
    model.top_tree.push_back({std::uint32_t(model.top_parts.size()), std::uint32_t(parts.size())});
    model.top_parts.insert(model.top_parts.end(), parts.begin(), parts.end());
    return {kSpanningNodes, std::uint32_t(model.top_tree.size() - 1)};
  }

  /// `weights` of the leaves from `first` on.
  void append_parts(std::uint32_t node, std::uint32_t first, std::span<const double> weights, Model& model,
                    std::vector<SpannedPart>& parts) {
    const TreeNodeRange& range = senders_.tree.nodes[node];
    if (!in_one_system(node)) {
      append_parts(range.left, first, weights, model, parts);
      append_parts(range.left + 1, first, weights, model, parts);
      return;
    }
    use(node, model);
    const auto own = weights.subspan(range.first - first, range.count);
    parts.push_back({references_[node], float(std::accumulate(own.begin(), own.end(), 0.0))});
  }

  static constexpr std::uint32_t kUnused = 0xfffffffdu;
  const SenderTree& senders_;
  const NodeFlux* flux_;
  std::vector<SenderRef> references_;
};

}  // namespace relume
