// SPDX-License-Identifier: MIT
//
// Clusters: connected groups of surface elements of about one size, whatever the tessellation. A group never
// contains two elements that are not joined through links inside it, so none lies on two sides of a wall.
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/elements.h"

namespace relume {

/// How large clusters become.
struct ClusterSizes {
  double largest = 0.0;  ///< m
  double clearance_share =
      0.0;  ///< above 0: nor larger than this share of the clearance of what they are made of
  std::vector<float> clearances;  ///< per element; used with a share
};

/// Cluster of each element of the system, numbered from 0 in the order of the chart, then of the block, then
/// of the first element. `texel_sizes` (per node) in metres. Each chart is cut in blocks of about the largest
/// size, these in halves where clearances ask for smaller ones; the connected parts of a block are clusters;
/// those much smaller than a block join a near one of the same node, material and side that they see, while
/// the union stays small.
std::vector<std::uint32_t> make_clusters(const Geometry& geometry, const std::vector<Chart>& charts,
                                         const AtlasLayout& layout, const SystemSurface& surface,
                                         const RayCaster& caster, const std::vector<double>& texel_sizes,
                                         const ClusterSizes& sizes);

}  // namespace relume
