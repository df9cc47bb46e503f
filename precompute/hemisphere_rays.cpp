// SPDX-License-Identifier: MIT
#include "precompute/hemisphere_rays.h"

#include <limits>

namespace relume {
namespace {

void set_ray(RayPacket& packet, int lane, const glm::vec3& origin, const glm::vec3& direction) {
  packet.origin_x[lane] = origin.x, packet.origin_y[lane] = origin.y, packet.origin_z[lane] = origin.z;
  packet.direction_x[lane] = direction.x, packet.direction_y[lane] = direction.y,
  packet.direction_z[lane] = direction.z;
  packet.near[lane] = 0.0f;
  packet.far[lane] = std::numeric_limits<float>::infinity();
}

void set_unused(RayPacket& packet, int lane) {
  set_ray(packet, lane, glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f));
  packet.far[lane] = -1.0f;
}

}  // namespace

void fill_packet(const Geometry& geometry, const RayCaster& caster, const Receiver& receiver,
                 const SobolPoints& points, std::uint64_t key, std::uint32_t first,
                 HemispherePacket& packet) {
  for (int lane = 0; lane < kPacketSize; ++lane) {
    packet.used[lane] = false;
    set_unused(packet.rays, lane);
    if (first + std::uint32_t(lane) >= points.count()) continue;
    const SamplePoint s = points.scrambled(first + std::uint32_t(lane), key);
    const SurfacePoint origin = receiver.sample(geometry, s[2], s[3]);
    if (!receiver.owns(geometry, caster, origin)) continue;
    packet.used[lane] = true;
    packet.normals[lane] = origin.normal;
    set_ray(packet.rays, lane, origin.position + origin.normal * geometry.offset,
            frame_about(origin.normal).to_world(cosine_direction(s[0], s[1])));
  }
}

}  // namespace relume
