// SPDX-License-Identifier: MIT
#include "tool/row_views.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "core/sender_leaves.h"

namespace relume {
namespace {

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

std::vector<double> tree_levels(const Model& model, std::size_t s) {
  const LeafNumbers numbers(model);
  const System& system = model.systems[s];
  std::vector<double> level;
  for (const SenderRef& sender : system.imports)
    level.push_back(std::log2(double(std::max<std::size_t>(1, leaf_count(numbers.leaves_of(sender))))));
  const CsrMatrix rows = decode(system.gather);
  std::vector<double> levels(rows.rows, 0.0);
  for (std::uint32_t row = 0; row < rows.rows; ++row) {
    double all = 0.0, sum = 0.0;
    for (std::uint64_t e = rows.row_offsets[row]; e < rows.row_offsets[row + 1]; ++e) {
      all += rows.values[e];
      sum += rows.values[e] * level[rows.column_indices[e]];
    }
    if (all > 0.0) levels[row] = sum / all;
  }
  return levels;
}

std::vector<double> row_sums(const Model& model, std::size_t s) {
  const CsrMatrix rows = decode(model.systems[s].gather);
  std::vector<double> sums(rows.rows, 0.0);
  for (std::uint32_t row = 0; row < rows.rows; ++row) {
    for (std::uint64_t e = rows.row_offsets[row]; e < rows.row_offsets[row + 1]; ++e)
      sums[row] += rows.values[e];
  }
  return sums;
}

std::vector<double> row_lengths(const Model& model, std::size_t s) {
  const CsrMatrix rows = decode(model.systems[s].gather);
  std::vector<double> lengths;
  for (std::uint32_t row = 0; row < rows.rows; ++row)
    lengths.push_back(double(rows.row_offsets[row + 1] - rows.row_offsets[row]));
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
  return densities;
}

}  // namespace relume
