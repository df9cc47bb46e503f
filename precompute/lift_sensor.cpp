// SPDX-License-Identifier: MIT
#include "precompute/lift_sensor.h"

#include <glm/geometric.hpp>

namespace relume {

SurfacePoint lift_sensor(const Geometry& geometry, const RayCaster& caster, const glm::dvec3& position,
                         const glm::dvec3& normal) {
  const glm::vec3 up(glm::normalize(normal));
  const glm::vec3 at(position - geometry.origin);
  const float reach = 1e-4f * glm::length(geometry.upper - geometry.lower);
  RayPacket packet{};
  packet.far.fill(-1.0f);
  const glm::vec3 from = at + up * reach;
  packet.origin_x[0] = from.x, packet.origin_y[0] = from.y, packet.origin_z[0] = from.z;
  packet.direction_x.fill(-up.x), packet.direction_y.fill(-up.y), packet.direction_z.fill(-up.z);
  // A little further than the sensor: rounding may put the surface that it lies on behind it.
  packet.far[0] = reach + 2.0f * geometry.offset;
  caster.closest_hits(packet, RaySpread::wide, AlphaTest::solid);
  if (packet.triangle[0] == kNoTriangle) return {at, up};
  return {from - up * packet.far[0] + up * geometry.offset, up};
}

}  // namespace relume
