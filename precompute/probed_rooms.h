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

/// The room of each element, by systems. Found once: clusters of other sizes are lit in the same places, so
/// that what they are estimated to cost can be compared.
struct ElementRooms {
  std::vector<std::vector<std::uint32_t>> of_element;
  std::uint32_t count = 0;  ///< 0: not found yet
};

struct ProbedRoom {
  std::vector<std::uint32_t> clusters;  ///< may be none, of a room smaller than those
  std::vector<SurfacePoint> places;     ///< middles of its elements
  std::vector<float> area_up_to;        ///< with each of these

  float area() const { return area_up_to.back(); }  ///< m2
  /// The middle of an element, as often as it is large; `u` in [0, 1).
  const SurfacePoint& choose(float u) const {
    const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end() - 1, u * area());
    return places[std::size_t(found - area_up_to.begin())];
  }
};

/// The room of each cluster, in the order of systems: that of its largest element.
std::vector<std::uint32_t> rooms_of_clusters(const std::vector<ClusteredSurface>& surfaces,
                                             const ElementRooms& rooms);

/// By numbers of senders.
std::vector<ProbedCluster> probed_clusters(const std::vector<ClusteredSurface>& surfaces);

/// `of_cluster` by numbers of senders.
std::vector<ProbedRoom> probed_rooms(const std::vector<ClusteredSurface>& surfaces, const ElementRooms& rooms,
                                     const std::vector<std::uint32_t>& of_cluster);

}  // namespace relume
