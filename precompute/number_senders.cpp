// SPDX-License-Identifier: MIT
#include "precompute/number_senders.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>

#include "core/sky.h"
#include "precompute/sender_set.h"

namespace relume {
namespace {

/// Sets of clusters that are joined one pair after the other.
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// The smaller number stands for the set.
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::vector<std::uint32_t> find_rooms(const std::vector<ClusteredSurface>& surfaces,
                                      const std::vector<SystemRows>& rows, std::uint32_t cluster_count) {
  JoinedSets sets(cluster_count);
  for (std::size_t s = 0; s < rows.size(); ++s) {
    for (std::uint32_t c = 0; c < rows[s].clusters.size(); ++c) {
      for (const auto sender : rows[s].clusters[c].senders) {
        if (sender < cluster_count) sets.join(surfaces[s].first_cluster + c, sender);
      }
    }
  }
  std::vector<std::uint32_t> rooms(cluster_count);
  for (std::uint32_t c = 0; c < cluster_count; ++c) rooms[c] = sets.find(c);
  return rooms;
}

/// Appends the clusters of system `part`.
void append_leaves(const ClusteredSurface& surface, std::uint32_t part, const Emitters& emitters,
                   const std::vector<std::uint32_t>& rooms, std::vector<TreeLeaf>& all) {
  std::vector<TreeLeaf> leaves(surface.cluster_count);
  for (std::size_t e = 0; e < surface.cluster.size(); ++e) {
    const Element& element = surface.surface.elements[e];
    TreeLeaf& leaf = leaves[surface.cluster[e]];
    leaf.area += element.area;
    leaf.centroid += element.area * element.position;
    leaf.normal += element.area * element.normal;
  }
  for (std::uint32_t c = 0; c < leaves.size(); ++c) {
    const std::uint32_t cluster = surface.first_cluster + c;
    leaves[c].centroid /= leaves[c].area;
    leaves[c].normal /= leaves[c].area;
    leaves[c].group = 2 * rooms[cluster] + (emitters.of_cluster[cluster] != kNone ? 1u : 0u);
    leaves[c].part = part;
    all.push_back(leaves[c]);
  }
}

template <class T>
std::vector<T> in_order(const std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> ordered;
  for (const auto i : order) ordered.push_back(values[i]);
  return ordered;
}

/// Gives the entries of rows new numbers; one per thread.
class Renumbering {
 public:
  /// `numbers` per old sender: the new one; kNone where no row sees it.
  explicit Renumbering(const std::vector<std::uint32_t>& numbers)
      : numbers_(numbers), values_(numbers.size(), 0.0f), used_(numbers.size()) {}

  void apply(FormFactorRow& row) {
    for (std::size_t i = 0; i < row.senders.size(); ++i) {
      const std::uint32_t number = numbers_[row.senders[i]];
      values_[number] = row.values[i];
      used_.insert(number);
    }
    std::size_t next = 0;
    used_.drain([&](std::uint32_t number) {
      row.senders[next] = number;
      row.values[next++] = values_[number];
    });
  }

 private:
  const std::vector<std::uint32_t>& numbers_;
  std::vector<float> values_;  ///< per new number, where used
  SenderSet used_;
};

void renumber(const std::vector<std::uint32_t>& numbers, std::vector<FormFactorRow>& rows) {
  tbb::enumerable_thread_specific<Renumbering> renumberings([&] { return Renumbering(numbers); });
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) { renumberings.local().apply(rows[i]); });
}

/// The clusters of all systems; `numbers` gets the new ones.
void number_clusters(const Emitters& emitters, const std::vector<std::uint32_t>& old_rooms,
                     std::vector<ClusteredSurface>& surfaces, std::vector<SystemRows>& rows,
                     SenderTree& senders, std::vector<std::uint32_t>& numbers) {
  std::vector<TreeLeaf> leaves;
  for (std::uint32_t s = 0; s < surfaces.size(); ++s)
    append_leaves(surfaces[s], s, emitters, old_rooms, leaves);
  const std::vector<std::uint32_t> order = tree_order(leaves);
  append_tree(in_order(leaves, order), 0, senders.tree);
  std::vector<std::vector<std::uint32_t>> local_order(surfaces.size());
  std::vector<std::uint32_t> local_numbers(leaves.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const std::uint32_t s = leaves[order[i]].part;
    local_numbers[order[i]] = std::uint32_t(local_order[s].size());
    local_order[s].push_back(order[i] - surfaces[s].first_cluster);
    numbers[order[i]] = i;
    senders.places.push_back({s, local_numbers[order[i]]});
    senders.weights.push_back(leaves[order[i]].area);
  }
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for (auto& cluster : surfaces[s].cluster) cluster = local_numbers[surfaces[s].first_cluster + cluster];
    std::vector<FormFactorRow> ordered;
    for (const auto c : local_order[s]) ordered.push_back(std::move(rows[s].clusters[c]));
    rows[s].clusters = std::move(ordered);
  }
}

std::vector<bool> seen_senders(std::size_t count, const std::vector<SystemRows>& rows,
                               const std::vector<FormFactorRow>& sensor_rows) {
  std::vector<bool> seen(count, false);
  const auto mark = [&](const std::vector<FormFactorRow>& some) {
    for (const FormFactorRow& row : some) {
      for (const auto sender : row.senders) seen[sender] = true;
    }
  };
  for (const SystemRows& system : rows) {
    mark(system.clusters);
    mark(system.elements);
  }
  mark(sensor_rows);
  return seen;
}

void number_sky(const std::vector<bool>& seen, std::uint32_t cluster_count, std::uint32_t sky_resolution,
                SenderTree& senders, std::vector<std::uint32_t>& numbers) {
  std::vector<std::uint32_t> cells;
  std::vector<TreeLeaf> leaves;
  for (std::uint32_t cell = 0; cell < 6 * sky_resolution * sky_resolution; ++cell) {
    if (!seen[cluster_count + cell]) continue;
    cells.push_back(cell);
    leaves.push_back({glm::vec3(sky_cell_direction(cell, sky_resolution)), glm::vec3(0.0f),
                      float(sky_cell_solid_angle(cell, sky_resolution)), 0, 0});
  }
  const std::vector<std::uint32_t> order = tree_order(leaves);
  append_tree(in_order(leaves, order), cluster_count, senders.tree);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    numbers[cluster_count + cells[order[i]]] = cluster_count + i;
    senders.places.push_back({kSkySystem, i});
    senders.weights.push_back(leaves[order[i]].area);
    senders.sky_cells.push_back(cells[order[i]]);
  }
}

}  // namespace

SenderTree number_senders(const Emitters& emitters, std::uint32_t sky_resolution,
                          std::vector<ClusteredSurface>& surfaces, std::vector<SystemRows>& rows,
                          std::vector<FormFactorRow>& sensor_rows) {
  const std::uint32_t cluster_count = surfaces.back().first_cluster + surfaces.back().cluster_count;
  const std::vector<std::uint32_t> rooms = find_rooms(surfaces, rows, cluster_count);
  std::vector<std::uint32_t> numbers(cluster_count + 6 * sky_resolution * sky_resolution, kNone);
  const std::vector<bool> seen = seen_senders(numbers.size(), rows, sensor_rows);
  SenderTree senders;
  number_clusters(emitters, rooms, surfaces, rows, senders, numbers);
  number_sky(seen, cluster_count, sky_resolution, senders, numbers);
  for (SystemRows& system : rows) {
    renumber(numbers, system.clusters);
    renumber(numbers, system.elements);
  }
  renumber(numbers, sensor_rows);
  return senders;
}

std::vector<std::uint32_t> systems_of_sensors(const SenderTree& senders, std::size_t systems,
                                              const std::vector<FormFactorRow>& sensor_rows) {
  std::vector<std::uint32_t> result;
  for (const FormFactorRow& row : sensor_rows) {
    std::vector<double> seen(systems, 0.0);
    for (std::size_t i = 0; i < row.senders.size(); ++i) {
      const SenderRef& place = senders.places[row.senders[i]];
      if (place.system != kSkySystem) seen[place.system] += row.values[i];
    }
    result.push_back(std::uint32_t(std::max_element(seen.begin(), seen.end()) - seen.begin()));
  }
  return result;
}

}  // namespace relume
