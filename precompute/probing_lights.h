// SPDX-License-Identifier: MIT
//
// The lights of the probing emissions (precompute/probing.h): what they leave on surfaces at first hand.
#pragma once

#include <vector>

#include "precompute/probed_rooms.h"
#include "precompute/probing.h"

namespace relume {

/// Where they shine. Borrows all.
struct ProbedPlaces {
  const ProbedScene& scene;
  const std::vector<ProbedCluster>& clusters;
  const std::vector<ProbedRoom>& rooms;
  const std::vector<std::uint32_t>& of_cluster;  ///< room of each cluster
  const LitRooms& lit;                           ///< only numbers are needed; other rooms glow
};

struct ProbingLights {
  std::vector<ProbingValues> emitted;   ///< per cluster: exitance, lm/m2
  std::vector<ProbingValues> arriving;  ///< per cluster: direct irradiance, lux
  std::vector<ProbingValues> sky;       ///< per sky cell: pi times its luminance
};

/// In the calling task arena; the same for any number of threads.
ProbingLights probing_lights(const ProbedPlaces& places);

}  // namespace relume
