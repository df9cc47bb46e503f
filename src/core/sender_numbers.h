// SPDX-License-Identifier: MIT
//
// The numbers of all senders of a model in the columns of a SenderMatrix, and the means that its nodes are.
#pragma once

#include <cstdint>
#include <vector>

#include "core/block_matrix.h"
#include "core/sender_leaves.h"

namespace relume {

/// Senders numbered through: leaves (clusters, sky patches), nodes of each system, nodes of the sky, nodes
/// above the systems.
class SenderNumbers {
 public:
  explicit SenderNumbers(const Model& model) : model_(model), leaves_(model), next_(leaves_.count()) {
    for (const System& system : model.systems) add_nodes(system.tree.nodes.size());
    add_nodes(model.sky_tree.nodes.size());
    add_nodes(model.top_tree.size());
  }

  const LeafNumbers& leaves() const { return leaves_; }
  std::uint32_t senders() const { return next_; }
  /// kNone: nothing of the sender is loaded.
  std::uint32_t number(const SenderRef& sender) const {
    const SenderLeaves leaves = leaves_.leaves_of(sender);
    if (leaves.ranges.empty()) return kNone;
    const std::size_t systems = model_.systems.size();
    if (sender.system == kSpanningNodes) return first_node_[systems + 1] + sender.index;
    const bool sky = sender.system == kSkySystem;
    const std::size_t own = sky ? model_.sky_cells.size() : model_.systems[sender.system].clusters.size();
    if (sender.index < own) return leaves.ranges.front().first;
    return first_node_[sky ? systems : sender.system] + (sender.index - static_cast<std::uint32_t>(own));
  }
  std::vector<std::uint32_t> of_imports(const System& system) const {
    std::vector<std::uint32_t> numbers;
    for (const SenderRef& sender : system.imports) numbers.push_back(number(sender));
    return numbers;
  }

 private:
  void add_nodes(std::size_t count) {
    first_node_.push_back(next_);
    next_ += static_cast<std::uint32_t>(count);
  }

  const Model& model_;
  LeafNumbers leaves_;
  std::uint32_t next_ = 0;
  std::vector<std::uint32_t> first_node_;  ///< per system, of the sky, above the systems
};

/// Without rows.
CsrMatrix empty_matrix(std::uint32_t columns);

/// P: nodes in the order of SenderNumbers.
CsrMatrix node_matrix(const Model& model, const LeafNumbers& numbers);

}  // namespace relume
