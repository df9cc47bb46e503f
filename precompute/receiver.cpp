// SPDX-License-Identifier: MIT
#include "precompute/receiver.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace relume {
namespace {

/// Corners of a piece, moved towards `middle` by twice what rays are lifted by.
std::array<glm::vec3, 3> inner_corners(const Geometry& geometry, const SurfacePiece& shape,
                                       const glm::vec3& middle) {
  std::array<glm::vec3, 3> corners{};
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 corner = geometry.point(shape.triangle, shape.corners[k].x, shape.corners[k].y);
    const glm::vec3 inward = middle - corner;
    const float distance = glm::length(inward);
    const float share = distance > 0.0f ? std::min(1.0f, 2.0f * geometry.offset / distance) : 0.0f;
    corners[k] = corner + inward * share;
  }
  return corners;
}

}  // namespace

Receiver Receiver::element(const Geometry& geometry, const RayCaster& caster, const SystemSurface& surface,
                           const Element& element, Side side) {
  Receiver receiver;
  receiver.middle_ = {element.position, element.normal};
  receiver.radius_ = std::sqrt(element.area / 3.14159265f);
  for (std::uint32_t p = 0; p < element.piece_count; ++p) {
    const Piece& piece = surface.pieces[element.first_piece + p];
    const glm::vec3 normal = geometry.normal(piece.shape.triangle, side);
    const auto corners = inner_corners(geometry, piece.shape, element.position);
    receiver.origins_.add(corners, normal, piece.area);
    if (!element.walled) continue;
    receiver.open_.push_back(std::all_of(corners.begin(), corners.end(), [&](const glm::vec3& corner) {
      return mutually_visible(geometry, caster, receiver.middle_, {corner, normal});
    }));
  }
  return receiver;
}

Receiver Receiver::point(const SurfacePoint& at) {
  Receiver receiver;
  receiver.middle_ = at;
  receiver.origins_.add({at.position, at.position, at.position}, at.normal, 1.0f);
  return receiver;
}

std::uint64_t Receiver::key() const {
  std::uint64_t key = 0x52656c756d65ull;
  for (const float value : {middle_.position.x, middle_.position.y, middle_.position.z, middle_.normal.x,
                            middle_.normal.y, middle_.normal.z}) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    key = mix(key, bits);
  }
  return key;
}

}  // namespace relume
