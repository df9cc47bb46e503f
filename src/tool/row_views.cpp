// SPDX-License-Identifier: MIT
#include "tool/row_views.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

#include "core/sender_leaves.h"

namespace relume {
namespace {

void divide_by_largest(std::vector<double>& values) {
  const double most = values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
  if (most <= 0.0) return;
  for (double& value : values) value /= most;
}

std::size_t leaf_count(const SenderLeaves& leaves) {
  std::size_t count = 0;
  for (const LeafRange& range : leaves.ranges) count += range.count;
  return count;
}

}  // namespace

std::vector<double> shares_of_nodes(const Model& model, std::size_t s) {
  const LeafNumbers numbers(model);
  const System& system = model.systems[s];
  std::vector<bool> is_node;
  for (const SenderRef& sender : system.imports) is_node.push_back(leaf_count(numbers.leaves_of(sender)) > 1);
  const CsrMatrix rows = decode(system.gather);
  std::vector<double> shares(rows.rows, 0.0);
  for (std::uint32_t row = 0; row < rows.rows; ++row) {
    double all = 0.0, of_nodes = 0.0;
    for (std::uint64_t e = rows.row_offsets[row]; e < rows.row_offsets[row + 1]; ++e) {
      all += rows.values[e];
      if (is_node[rows.column_indices[e]]) of_nodes += rows.values[e];
    }
    if (all > 0.0) shares[row] = of_nodes / all;
  }
  return shares;
}

std::vector<double> relative_row_lengths(const Model& model, std::size_t s) {
  const CsrMatrix rows = decode(model.systems[s].gather);
  std::vector<double> lengths;
  for (std::uint32_t row = 0; row < rows.rows; ++row)
    lengths.push_back(double(rows.row_offsets[row + 1] - rows.row_offsets[row]));
  divide_by_largest(lengths);
  return lengths;
}

ChosenLumel nearest_lumel(const Model& model, const glm::dvec3& place) {
  ChosenLumel nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    for (std::size_t l = 0; l < system.lumels.size(); ++l) {
      if ((system.lumels[l].flags & kLumelInvalid) != 0) continue;
      const glm::dvec3 middle(system.elements[system.lumels[l].element].position);
      const double distance = glm::distance(model.origin + middle, place);
      if (distance < nearest.distance) nearest = {s, l, distance};
    }
  }
  return nearest;
}

std::vector<double> form_factor_densities(const Model& model, const ChosenLumel& receiver) {
  const LeafNumbers numbers(model);
  const System& system = model.systems[receiver.system];
  const CsrMatrix rows = decode(system.gather);
  std::vector<double> densities(numbers.count(), 0.0);
  for (std::uint64_t e = rows.row_offsets[receiver.lumel]; e < rows.row_offsets[receiver.lumel + 1]; ++e) {
    const SenderLeaves leaves = numbers.leaves_of(system.imports[rows.column_indices[e]]);
    for (const LeafRange& range : leaves.ranges) {
      for (std::uint32_t i = 0; i < range.count; ++i)
        densities[range.first + i] += rows.values[e] * range.share_of(i);
    }
  }
  densities.resize(cluster_offsets(model).back());
  std::size_t cluster = 0;
  for (const System& part : model.systems) {
    for (const Cluster& c : part.clusters) densities[cluster++] /= double(c.area);
  }
  divide_by_largest(densities);
  return densities;
}

}  // namespace relume
