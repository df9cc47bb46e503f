// SPDX-License-Identifier: MIT
#include "core/sender_numbers.h"

namespace relume {
namespace {

/// Appends a row of P.
void append_node(const SenderRef& node, const LeafNumbers& numbers, CsrMatrix& nodes) {
  const SenderLeaves leaves = numbers.leaves_of(node);
  for (const LeafRange& range : leaves.ranges) {
    for (std::uint32_t i = 0; i < range.count; ++i) {
      nodes.column_indices.push_back(range.first + i);
      nodes.values.push_back(range.share_of(i));
    }
  }
  nodes.row_offsets.push_back(nodes.values.size());
  ++nodes.rows;
}

}  // namespace

CsrMatrix empty_matrix(std::uint32_t columns) {
  CsrMatrix matrix;
  matrix.columns = columns;
  matrix.row_offsets.push_back(0);
  return matrix;
}

CsrMatrix node_matrix(const Model& model, const LeafNumbers& numbers) {
  CsrMatrix nodes = empty_matrix(numbers.count());
  const auto append = [&](std::size_t system, std::size_t first, std::size_t count) {
    for (std::size_t n = first; n < first + count; ++n)
      append_node({static_cast<std::uint32_t>(system), static_cast<std::uint32_t>(n)}, numbers, nodes);
  };
  for (std::size_t s = 0; s < model.systems.size(); ++s)
    append(s, model.systems[s].clusters.size(), model.systems[s].tree.nodes.size());
  append(kSkySystem, model.sky_cells.size(), model.sky_tree.nodes.size());
  append(kSpanningNodes, 0, model.top_tree.size());
  return nodes;
}

}  // namespace relume
