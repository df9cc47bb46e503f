// SPDX-License-Identifier: MIT
#include "precompute/clearance.h"

#include <tbb/parallel_for.h>

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
    const Receiver receiver =
        Receiver::element(geometry, caster, surface, element, charts[element.chart].side);
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

}  // namespace relume
