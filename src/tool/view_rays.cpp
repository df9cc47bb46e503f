// SPDX-License-Identifier: MIT
#include "tool/view_rays.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace relume {
namespace {

/// Backs that a ray may pass before it is taken to meet nothing.
constexpr int kMostBacks = 64;

void disable(RayPacket& packet, int lane) {
  packet.near[lane] = 1.0f;
  packet.far[lane] = 0.0f;
}

}  // namespace

RayPacket packet_of(const ViewRays& rays) {
  RayPacket packet;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    packet.origin_x[lane] = rays[lane].origin.x;
    packet.origin_y[lane] = rays[lane].origin.y;
    packet.origin_z[lane] = rays[lane].origin.z;
    packet.direction_x[lane] = rays[lane].direction.x;
    packet.direction_y[lane] = rays[lane].direction.y;
    packet.direction_z[lane] = rays[lane].direction.z;
    packet.near[lane] = 0.0f;
    packet.far[lane] = std::numeric_limits<float>::max();
  }
  return packet;
}

ViewHits trace(const Model& model, const RayCaster& caster, const ViewRays& rays) {
  ViewHits hits;
  RayPacket packet = packet_of(rays);
  for (int pass = 0, open = kPacketSize; open > 0 && pass < kMostBacks; ++pass) {
    caster.closest_hits(packet);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (packet.far[lane] < packet.near[lane]) continue;
      const std::uint32_t triangle = packet.triangle[lane];
      if (triangle != kNoTriangle) {
        const SeenPoint point =
            seen_point(model, triangle, {packet.u[lane], packet.v[lane]}, rays[lane].direction);
        if (hidden_back(model, point)) {
          packet.near[lane] = packet.far[lane] * (1.0f + 4e-6f) + std::numeric_limits<float>::min();
          packet.far[lane] = std::numeric_limits<float>::max();
          continue;
        }
        hits[lane] = {true, packet.far[lane], point};
      }
      disable(packet, lane);
      --open;
    }
  }
  return hits;
}

ViewFrame::ViewFrame(const Model& model, const Camera& camera, double aspect)
    : origin_(camera.position - model.origin), forward_(glm::normalize(camera.forward)) {
  glm::dvec3 side = glm::cross(forward_, camera.up);
  if (glm::length(side) < 1e-6)
    side = glm::cross(forward_, std::abs(forward_.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1));
  side = glm::normalize(side);
  const double half_height = std::tan(0.5 * camera.vertical_field_of_view);
  right_ = side * half_height * aspect;
  up_ = glm::cross(side, forward_) * half_height;
}

ViewRay ViewFrame::ray(const glm::dvec2& place) const {
  const glm::dvec3 direction = forward_ + (2.0 * place.x - 1.0) * right_ + (1.0 - 2.0 * place.y) * up_;
  return {glm::vec3(origin_), glm::vec3(glm::normalize(direction))};
}

}  // namespace relume
