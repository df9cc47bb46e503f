// SPDX-License-Identifier: MIT
//
// Cosine-distributed rays from a receiver, packet by packet.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "precompute/geometry.h"
#include "precompute/ray_caster.h"
#include "precompute/receiver.h"
#include "precompute/sampling.h"

namespace relume {

/// A packet before it is traced. Lanes without a ray (beyond the last point, or where a wall cuts into the
/// receiver) have far < near.
struct HemispherePacket {
  RayPacket rays;
  std::array<glm::vec3, kPacketSize> normals;  ///< of the surface at each origin
  std::array<bool, kPacketSize> used;
};

/// Rays of points [first, first + kPacketSize) of the sequence that belongs to `key`.
void fill_packet(const Geometry& geometry, const RayCaster& caster, const Receiver& receiver,
                 const SobolPoints& points, std::uint64_t key, std::uint32_t first, HemispherePacket& packet);

}  // namespace relume
