// SPDX-License-Identifier: MIT
#include "precompute/probed_rooms.h"

namespace relume {

std::vector<ProbedCluster> probed_clusters(const std::vector<ClusteredSurface>& surfaces) {
  std::vector<ProbedCluster> clusters;
  for (const ClusteredSurface& own : surfaces) {
    clusters.resize(std::max<std::size_t>(clusters.size(),
                                          1 + *std::max_element(own.senders.begin(), own.senders.end())));
    std::vector<float> largest(own.cluster_count, 0.0f);
    for (std::size_t e = 0; e < own.cluster.size(); ++e) {
      const Element& element = own.surface.elements[e];
      ProbedCluster& cluster = clusters[own.sender_of(std::uint32_t(e))];
      cluster.area += element.area;
      cluster.material = element.material;
      if (element.area <= largest[own.cluster[e]]) continue;
      largest[own.cluster[e]] = element.area;
      cluster.at = {element.position, element.normal};
    }
  }
  return clusters;
}

std::vector<ProbedRoom> probed_rooms(const std::vector<ClusteredSurface>& surfaces, const ElementRooms& rooms,
                                     const std::vector<std::uint32_t>& of_cluster) {
  std::vector<ProbedRoom> probed(rooms.count);
  std::vector<double> areas(rooms.count, 0.0);
  for (std::uint32_t c = 0; c < of_cluster.size(); ++c) probed[of_cluster[c]].clusters.push_back(c);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for (std::size_t e = 0; e < rooms.of_element[s].size(); ++e) {
      const Element& element = surfaces[s].surface.elements[e];
      const std::uint32_t room = rooms.of_element[s][e];
      areas[room] += element.area;
      probed[room].places.push_back({element.position, element.normal});
      probed[room].area_up_to.push_back(float(areas[room]));
    }
  }
  return probed;
}

std::vector<std::uint32_t> rooms_of_clusters(const std::vector<ClusteredSurface>& surfaces,
                                             const ElementRooms& rooms) {
  std::vector<std::uint32_t> of_cluster;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const ClusteredSurface& own = surfaces[s];
    std::vector<float> largest(own.cluster_count, 0.0f);
    of_cluster.resize(own.first_cluster + own.cluster_count);
    for (std::size_t e = 0; e < own.cluster.size(); ++e) {
      const float area = own.surface.elements[e].area;
      if (area <= largest[own.cluster[e]]) continue;
      largest[own.cluster[e]] = area;
      of_cluster[own.first_cluster + own.cluster[e]] = rooms.of_element[s][e];
    }
  }
  return of_cluster;
}

}  // namespace relume
