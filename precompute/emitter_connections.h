// SPDX-License-Identifier: MIT
//
// Lines of sight from a receiver to points of an emitter, packet by packet, and how their estimate of a form
// factor is combined with that of hemisphere rays.
#pragma once

#include <array>
#include <cstdint>

#include "precompute/emitters.h"
#include "precompute/ray_caster.h"
#include "precompute/receiver.h"
#include "precompute/sampling.h"

namespace relume {

/// How many samples two techniques take of the same form factor.
struct SampleCounts {
  std::uint32_t rays = 0;  ///< over the hemisphere of the receiver
  std::uint32_t area = 0;  ///< over the emitter
};

/// What one hemisphere ray that meets the emitter counts, instead of 1. Cosines are positive.
double ray_weight(const SampleCounts& counts, double emitter_area, double cos_receiver, double cos_emitter,
                  double distance);

struct ConnectionPacket {
  RayPacket rays;  ///< near 0, far 1, from receiver to emitter; far < near where there is nothing to gain
  PointLanes origins;
  std::array<double, kLanes> form_factor;  ///< of the lane when nothing is in between, weighted
};

/// Samples [first, first + kLanes) of the sequence that belongs to `key`; those from counts.area on are not
/// used. `offset` is what points are lifted by.
void fill_connections(const Receiver& receiver, const Emitter& emitter, const SampleCounts& counts,
                      const SobolPoints& points, std::uint64_t key, std::uint32_t first, float offset,
                      ConnectionPacket& packet);

}  // namespace relume
