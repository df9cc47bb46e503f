// SPDX-License-Identifier: MIT
#include "precompute/number_senders.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

#include "core/sky.h"
#include "precompute/sender_set.h"

namespace relume {
namespace {

/// What the leaves of one tree have in common: a room, and the material of possible emitters.
using LeafGroups = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>;

/// Appends the clusters of system `part`.
void append_leaves(const ClusteredSurface& surface, std::uint32_t part, const Emitters& emitters,
                   const std::vector<std::uint32_t>& rooms, LeafGroups& groups, std::vector<TreeLeaf>& all) {
  std::vector<TreeLeaf> leaves(surface.cluster_count);
  for (std::size_t e = 0; e < surface.cluster.size(); ++e) {
    const Element& element = surface.surface.elements[e];
    TreeLeaf& leaf = leaves[surface.cluster[e]];
    leaf.area += element.area;
    leaf.centroid += element.area * element.position;
    leaf.normal += element.area * element.normal;
  }
  for (std::uint32_t c = 0; c < leaves.size(); ++c) {
    const std::uint32_t cluster = surface.first_cluster + c, emitter = emitters.of_cluster[cluster];
    const std::uint32_t emits = emitter != kNone ? emitters.list[emitter].material : kNone;
    leaves[c].centroid /= leaves[c].area;
    leaves[c].normal /= leaves[c].area;
    leaves[c].group = groups.insert({{rooms[cluster], emits}, std::uint32_t(groups.size())}).first->second;
    leaves[c].part = part;
    all.push_back(leaves[c]);
  }
}

/// Gives the entries of rows new numbers; one per thread.
class Renumbering {
 public:
  /// `numbers` per old sender: the new one.
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

/// The clusters of all systems; `numbers` gets the new ones.
void number_clusters(const Emitters& emitters, const std::vector<std::uint32_t>& rooms,
                     std::vector<ClusteredSurface>& surfaces, SenderTree& senders,
                     std::vector<std::uint32_t>& numbers) {
  std::vector<TreeLeaf> leaves;
  LeafGroups groups;
  for (std::uint32_t s = 0; s < surfaces.size(); ++s)
    append_leaves(surfaces[s], s, emitters, rooms, groups, leaves);
  const std::vector<std::uint32_t> order = append_tree(leaves, 0, senders.tree);
  std::vector<std::uint32_t> local_numbers(leaves.size());
  for (ClusteredSurface& surface : surfaces) surface.senders.clear();
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const std::uint32_t s = leaves[order[i]].part;
    local_numbers[order[i]] = std::uint32_t(surfaces[s].senders.size());
    surfaces[s].senders.push_back(i);
    numbers[order[i]] = i;
    senders.places.push_back({s, local_numbers[order[i]]});
    senders.weights.push_back(leaves[order[i]].area);
  }
  for (ClusteredSurface& surface : surfaces) {
    for (auto& cluster : surface.cluster) cluster = local_numbers[surface.first_cluster + cluster];
  }
}

void number_sky(std::uint32_t cluster_count, SenderTree& senders, std::vector<std::uint32_t>& numbers) {
  std::vector<TreeLeaf> leaves;
  const std::uint32_t resolution = senders.sky_resolution;
  for (std::uint32_t cell = 0; cell < 6 * resolution * resolution; ++cell) {
    leaves.push_back({glm::vec3(sky_cell_direction(cell, resolution)), glm::vec3(0.0f),
                      float(sky_cell_solid_angle(cell, resolution)), 0, 0});
  }
  const std::vector<std::uint32_t> order = append_tree(leaves, cluster_count, senders.tree);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    numbers[cluster_count + order[i]] = cluster_count + i;
    senders.places.push_back({kSkySystem, i});
    senders.weights.push_back(leaves[order[i]].area);
    senders.sky_cells.push_back(order[i]);
  }
}

}  // namespace

SenderTree plain_senders(std::uint32_t sky_resolution, const std::vector<ClusteredSurface>& surfaces) {
  SenderTree senders;
  senders.sky_resolution = sky_resolution;
  for (std::uint32_t s = 0; s < surfaces.size(); ++s) {
    const ClusteredSurface& surface = surfaces[s];
    for (std::uint32_t c = 0; c < surface.cluster_count; ++c) senders.places.push_back({s, c});
    senders.weights.resize(surface.first_cluster + surface.cluster_count, 0.0);
    for (std::size_t e = 0; e < surface.cluster.size(); ++e)
      senders.weights[surface.first_cluster + surface.cluster[e]] += surface.surface.elements[e].area;
  }
  for (std::uint32_t cell = 0; cell < 6 * sky_resolution * sky_resolution; ++cell) {
    senders.places.push_back({kSkySystem, cell});
    senders.weights.push_back(sky_cell_solid_angle(cell, sky_resolution));
    senders.sky_cells.push_back(cell);
  }
  for (std::uint32_t i = 0; i < senders.weights.size(); ++i) senders.tree.nodes.push_back({i, 1, 0});
  return senders;
}

SenderTree number_senders(const Emitters& emitters, const std::vector<std::uint32_t>& rooms,
                          std::uint32_t sky_resolution, std::vector<ClusteredSurface>& surfaces,
                          std::vector<std::uint32_t>& numbers) {
  SenderTree senders;
  senders.sky_resolution = sky_resolution;
  numbers.assign(rooms.size() + 6 * sky_resolution * sky_resolution, kNone);
  number_clusters(emitters, rooms, surfaces, senders, numbers);
  number_sky(std::uint32_t(rooms.size()), senders, numbers);
  return senders;
}

void renumber(const std::vector<std::uint32_t>& numbers, std::vector<FormFactorRow>& rows) {
  tbb::enumerable_thread_specific<Renumbering> renumberings([&] { return Renumbering(numbers); });
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) { renumberings.local().apply(rows[i]); });
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
