// SPDX-License-Identifier: MIT
#include "precompute/clearance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "precompute/hemisphere_rays.h"

namespace relume {
namespace {

constexpr std::uint32_t kRays = 32;

}  // namespace

std::vector<float> clearances(const Geometry& geometry, const RayCaster& caster,
                              const std::vector<Chart>& charts, const SystemSurface& surface) {
  const SobolPoints points(kRays, kRays);
  std::vector<float> result(surface.elements.size());
  tbb::parallel_for(std::size_t{0}, result.size(), [&](std::size_t e) {
    const Element& element = surface.elements[e];
    const Receiver receiver = Receiver::element(geometry, surface, element, charts[element.chart].side);
    double inverse = 0.0, count = 0.0;
    HemispherePacket packet;
    for (std::uint32_t first = 0; first < kRays; first += kPacketSize) {
      fill_packet(geometry, caster, receiver, points, receiver.key(), first, packet);
      caster.closest_hits(packet.rays, RaySpread::narrow);
      for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
        if (!packet.used[lane]) continue;
        count += 1.0;
        if (packet.rays.triangle[lane] != kNoTriangle)
          inverse += 1.0 / std::max(double(packet.rays.far[lane]), double(geometry.offset));
      }
    }
    result[e] = inverse > 0.0 ? float(count / inverse) : std::numeric_limits<float>::infinity();
  });
  return result;
}

float free_radius(const RayCaster& caster, const glm::vec3& position) {
  constexpr std::uint32_t kDirections = 64;
  const SobolPoints points(kDirections, kDirections);
  float radius = std::numeric_limits<float>::infinity();
  for (std::uint32_t first = 0; first < kDirections; first += kPacketSize) {
    RayPacket packet;
    for (std::uint32_t lane = 0; lane < std::uint32_t(kPacketSize); ++lane) {
      const SamplePoint at = points.scrambled(first + lane, 0);
      const float height = 1.0f - 2.0f * at[0], reach = std::sqrt(std::max(0.0f, 1.0f - height * height));
      // On the unit circle without trigonometry: a direction drawn about +Z by cosine, laid flat.
      const glm::vec3 flat = cosine_direction(0.999f, at[1]);
      const glm::vec2 around = glm::normalize(glm::vec2(flat));
      packet.origin_x[lane] = position.x, packet.origin_y[lane] = position.y,
      packet.origin_z[lane] = position.z;
      packet.direction_x[lane] = reach * around.x, packet.direction_y[lane] = height;
      packet.direction_z[lane] = reach * around.y;
      packet.near[lane] = 0.0f, packet.far[lane] = std::numeric_limits<float>::infinity();
    }
    caster.closest_hits(packet);
    for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane)
      radius = std::min(radius, packet.far[lane]);
  }
  return radius;
}

}  // namespace relume
