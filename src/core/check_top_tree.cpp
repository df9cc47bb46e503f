// SPDX-License-Identifier: MIT
#include <numeric>

#include "core/model_checks.h"

namespace relume {
namespace {

/// A cluster or node of a system.
Result<void> check_part(const Model& model, std::size_t index) {
  const SpannedPart& part = model.top_parts[index];
  const std::string owner = fmt::format("nodes above the systems, part {}", index);
  if (part.sender.system >= model.systems.size()) {
    return broken_model("{}: expected a system below {}, found {}", owner, model.systems.size(),
                        part.sender.system);
  }
  return check_sender(model, part.sender, owner);
}

/// Each system once, so that no cluster counts twice.
Result<void> check_node(const Model& model, std::size_t index, std::uint64_t first_part) {
  const SpanningNode& node = model.top_tree[index];
  if (node.first_part != first_part || node.part_count < 2 ||
      first_part + node.part_count > model.top_parts.size()) {
    return broken_model(
        "node {} above the systems: expected at least 2 parts from {} on, found {} from {} on of {}", index,
        first_part, node.part_count, node.first_part, model.top_parts.size());
  }
  for (std::uint32_t p = node.first_part + 1; p < node.first_part + node.part_count; ++p) {
    const std::uint32_t before = model.top_parts[p - 1].sender.system,
                        here = model.top_parts[p].sender.system;
    if (before < here) continue;
    return broken_model("node {} above the systems: expected parts in systems that ascend, found {} after {}",
                        index, here, before);
  }
  std::vector<float> shares;
  for (std::uint32_t p = node.first_part; p < node.first_part + node.part_count; ++p)
    shares.push_back(model.top_parts[p].share);
  if (are_shares(shares)) return {};
  return broken_model("node {} above the systems: expected shares from 0 to 1 that add up to 1, found {}",
                      index, std::accumulate(shares.begin(), shares.end(), 0.0));
}

}  // namespace

Result<void> check_top_tree(const Model& model) {
  for (std::size_t index = 0; index < model.top_parts.size(); ++index) {
    if (auto checked = check_part(model, index); !checked) return checked;
  }
  std::uint64_t next_part = 0;
  for (std::size_t index = 0; index < model.top_tree.size(); ++index) {
    if (auto checked = check_node(model, index, next_part); !checked) return checked;
    next_part += model.top_tree[index].part_count;
  }
  if (next_part == model.top_parts.size()) return {};
  return broken_model("nodes above the systems: expected {} parts, as they have, found {}", next_part,
                      model.top_parts.size());
}

}  // namespace relume
