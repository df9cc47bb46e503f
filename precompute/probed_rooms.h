// SPDX-License-Identifier: MIT
//
// Clusters and rooms as the probing emissions (precompute/probing.h) see them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "precompute/mutual_visibility.h"
#include "precompute/sender_lookup.h"

namespace relume {

struct ProbedCluster {
  SurfacePoint at;  ///< middle of its largest element
  float area = 0.0f;
  std::uint32_t material = 0;
};

struct ProbedRoom {
  std::vector<std::uint32_t> clusters;
  std::vector<float> area_up_to;  ///< with each cluster

  float area() const { return area_up_to.back(); }  ///< m2
  /// A cluster, as often as it is large; `u` in [0, 1).
  std::uint32_t choose(float u) const {
    const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end() - 1, u * area());
    return clusters[std::size_t(found - area_up_to.begin())];
  }
};

/// By numbers of senders.
std::vector<ProbedCluster> probed_clusters(const std::vector<ClusteredSurface>& surfaces);

}  // namespace relume
