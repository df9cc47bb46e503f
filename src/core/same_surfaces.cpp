// SPDX-License-Identifier: MIT
#include "core/same_surfaces.h"

#include <array>
#include <bit>
#include <cstring>
#include <map>
#include <utility>

namespace relume {
namespace {

using ElementName = std::array<std::uint32_t, 6>;

ElementName name_of(const SurfaceElement& element) {
  ElementName name{};
  for (int k = 0; k < 3; ++k) {
    name[std::size_t(k)] = std::bit_cast<std::uint32_t>(element.position[k]);
    name[std::size_t(k) + 3] = std::bit_cast<std::uint32_t>(element.normal[k]);
  }
  return name;
}

/// What the other model looks its elements and sensors up in.
struct Known {
  std::map<ElementName, std::uint32_t> clusters;
  std::map<ElementName, std::uint32_t> lumels;
  std::map<std::string, std::uint32_t> sensors;
};

Known known_of(const Model& model) {
  Known known;
  const auto first_cluster = cluster_offsets(model), first_row = gather_offsets(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    for (const SurfaceElement& element : system.elements)
      known.clusters[name_of(element)] = first_cluster[s] + element.cluster;
    std::uint32_t row = first_row[s];
    for (const Lumel& lumel : system.lumels) known.lumels[name_of(system.elements[lumel.element])] = row++;
    for (const Sensor& sensor : system.sensors) known.sensors[model.sensor_names[sensor.name]] = row++;
  }
  return known;
}

tl::unexpected<Error> differ(const std::string& what) {
  return fail(ErrorCode::bad_input, "the files have other surfaces: " + what +
                                        "; expected the same scene, texel size and cluster size");
}

Result<void> add_system(const Model& to, std::size_t s, const Known& known, SameSurfaces& same) {
  const System& system = to.systems[s];
  const std::size_t first = same.clusters.size();
  same.clusters.resize(first + system.clusters.size(), kNone);
  for (const SurfaceElement& element : system.elements) {
    const auto found = known.clusters.find(name_of(element));
    if (found == known.clusters.end())
      return differ("a surface element of system '" + system.name + "' is not in both");
    std::uint32_t& cluster = same.clusters[first + element.cluster];
    if (cluster != kNone && cluster != found->second)
      return differ("a cluster of system '" + system.name + "' is in parts in the other file");
    cluster = found->second;
  }
  for (const Lumel& lumel : system.lumels) {
    const auto found = known.lumels.find(name_of(system.elements[lumel.element]));
    if (found == known.lumels.end()) return differ("a lumel of system '" + system.name + "' is not in both");
    same.gather_rows.push_back(found->second);
  }
  for (const Sensor& sensor : system.sensors) {
    const auto found = known.sensors.find(to.sensor_names[sensor.name]);
    if (found == known.sensors.end())
      return differ("sensor '" + to.sensor_names[sensor.name] + "' is not in both");
    same.gather_rows.push_back(found->second);
  }
  return {};
}

}  // namespace

Result<SameSurfaces> same_surfaces(const Model& from, const Model& to) {
  if (from.geometry_hash != to.geometry_hash) return differ("they are of different scenes");
  const std::uint32_t clusters = cluster_offsets(from).back();
  if (clusters != cluster_offsets(to).back()) {
    return differ(std::to_string(clusters) + " clusters and " + std::to_string(cluster_offsets(to).back()));
  }
  const Known known = known_of(from);
  SameSurfaces same;
  for (std::size_t s = 0; s < to.systems.size(); ++s) {
    if (auto added = add_system(to, s, known, same); !added) return tl::unexpected(added.error());
  }
  return same;
}

}  // namespace relume
