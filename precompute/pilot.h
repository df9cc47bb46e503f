// SPDX-License-Identifier: MIT
//
// A sample of the rows that will be traced: how noisy they are, and what cutting them costs.
#pragma once

#include <vector>

#include "precompute/cut.h"
#include "precompute/rows.h"

namespace relume {

/// Rows of the elements of one cluster.
struct PilotRows {
  std::vector<FormFactorRow> rows;
  std::vector<SurfacePoint> places;  ///< of each
  double squared_noise = 0.0;        ///< as row_noise finds it
  double weight = 0.0;               ///< of each element: its area over the mean
};

/// So many rays each.
inline constexpr std::uint32_t kPilotRays = 1024;

/// Of some hundred clusters, evenly spread over all. `mean_area` of elements, m2. In the calling task arena.
std::vector<PilotRows> trace_pilot(const RowScene& scene, const std::vector<Chart>& charts,
                                   const std::vector<ClusteredSurface>& systems, const Probing& probing,
                                   double mean_area, RowCounts& counts);

/// The exchange (RayLimits) at which the noise of all rows together is `noise` (mean square, by area,
/// relative to their rooms) for the fewest rays: where the next ray lessens it most, it goes. Noise is taken
/// to fall with the rays to the power of -3/4, as that of scrambled points over edges does.
double find_exchange(const std::vector<PilotRows>& pilot, const RayLimits& limits, double noise);

/// The error of single nodes (CutLimits) at which that of all rows together is `error` while rooms are lit as
/// the probings light them: so it takes the fewest nodes.
double find_node_error(const std::vector<PilotRows>& pilot, const ClusterTree& tree, const Probing& probing,
                       double error);

}  // namespace relume
