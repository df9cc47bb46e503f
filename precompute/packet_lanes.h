// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "precompute/ray_caster.h"

namespace relume {

/// One bit for each lane of a packet.
inline constexpr std::uint32_t kAllLanes = (1u << kPacketSize) - 1u;

/// Lanes outside of `lanes` have no ray.
inline void choose_lanes(std::uint32_t lanes, RayPacket& rays) {
  if (lanes == kAllLanes) return;
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    if ((lanes >> lane & 1u) == 0) rays.far[lane] = -1.0f;
  }
}

inline glm::vec3 direction_of(const RayPacket& rays, std::size_t lane) {
  return {rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]};
}

}  // namespace relume
