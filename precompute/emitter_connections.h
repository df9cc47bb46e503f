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

/// How many samples two techniques are expected to take of the same form factor.
struct SampleCounts {
  double rays = 0.0;  ///< over the hemisphere of the receiver
  double area = 0.0;  ///< over the emitter
};

/// What one hemisphere ray that meets the emitter counts, instead of 1. Cosines are positive.
double ray_weight(const SampleCounts& counts, double emitter_area, double cos_receiver, double cos_emitter,
                  double distance);

/// The weight of a sample that one technique draws with `own` density and the other with `other`: the power
/// heuristic of exponent 2. The balance heuristic would leave a small lamp's few hits by rays a share, and
/// all of their noise.
[[gnu::always_inline]] inline double power_heuristic(double own, double other) {
  return own * own / (own * own + other * other);
}

/// What both parts of a row are multiplied by, so that they add up to what the rays measured.
struct RowScales {
  double emitted = 1.0, counted = 1.0;
};

/// `counted` is at most `row_sum`. Each part takes a share of the difference by the square of its size: a
/// lamp's small part stays what its area samples say, and so does what little an emitting room leaves.
RowScales close_row(double emitted, double counted, double row_sum);

struct ConnectionPacket {
  RayPacket rays;  ///< near 0, far 1, from receiver to emitter; far < near where there is nothing to gain
  PointLanes origins;
  std::array<std::uint32_t, kLanes> emitter;  ///< index
  /// Of the emitter, when nothing is in between, over the chance of having chosen it; weighted.
  std::array<double, kLanes> form_factor;
};

/// What all packets of one row share.
struct Connections {
  const Receiver& receiver;
  const Emitters& emitters;
  const EmitterChoice& choice;
  std::uint32_t ray_count = 0;   ///< over the hemisphere
  std::uint32_t area_first = 0;  ///< where in the sequence their samples begin; a multiple of kLanes
  std::uint32_t area_count = 0;  ///< over all emitters
  float offset = 0.0f;           ///< m, what points are lifted by
};

/// Samples [first, first + kLanes), counted from area_first on, of the sequence that belongs to `key`; those
/// from area_count on are not used.
void fill_connections(const Connections& connections, const SobolPoints& points, std::uint64_t key,
                      std::uint32_t first, ConnectionPacket& packet);

}  // namespace relume
