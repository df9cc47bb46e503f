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

}  // namespace relume
