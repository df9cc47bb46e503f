// SPDX-License-Identifier: MIT
//
// Cosine-distributed rays from a receiver, packet by packet.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "precompute/geometry.h"
#include "precompute/ray_caster.h"
#include "precompute/receiver.h"
#include "precompute/sampling.h"

namespace relume {

/// A packet before it is traced. Lanes without a ray (beyond the last point, or where a wall cuts into the
/// receiver) have far < near.
struct HemispherePacket {
  RayPacket rays;
  PointLanes origins;                              ///< on the surface, not lifted
  std::array<std::uint32_t, kPacketSize> numbers;  ///< of their points in the sequence
  std::array<bool, kPacketSize> used;

  std::uint32_t used_lanes() const {  ///< as bits
    std::uint32_t lanes = 0;
    for (std::uint32_t lane = 0; lane < std::uint32_t(kPacketSize); ++lane)
      lanes |= used[lane] ? 1u << lane : 0u;
    return lanes;
  }

  /// Of the surface at the origin of a lane.
  const glm::vec3& normal(const Receiver& receiver, int lane) const {
    return receiver.origins().patch(origins.patch[std::size_t(lane)]).frame.normal;
  }
};

/// Rays of some points, at least one and at most kPacketSize, of the sequence that belongs to `key`. All of
/// their lanes are used, walls or not.
void make_packet(const Geometry& geometry, const Receiver& receiver, const SobolPoints& points,
                 std::uint64_t key, std::span<const std::uint32_t> some, HemispherePacket& packet);

/// Of points [first, first + kPacketSize), as far as there are, without the lanes where a wall cuts into the
/// receiver.
void fill_packet(const Geometry& geometry, const RayCaster& caster, const Receiver& receiver,
                 const SobolPoints& points, std::uint64_t key, std::uint32_t first, HemispherePacket& packet);

}  // namespace relume
