// SPDX-License-Identifier: MIT
#include "precompute/receiver.h"

#include <algorithm>
#include <bit>
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

Receiver Receiver::element(const Geometry& geometry, const SystemSurface& surface, const Element& element,
                           Side side) {
  Receiver receiver;
  receiver.middle_ = {element.position, element.normal};
  receiver.radius_ = std::sqrt(element.area / 3.14159265f);
  for (std::uint32_t p = 0; p < element.piece_count; ++p) {
    const Piece& piece = surface.pieces[element.first_piece + p];
    const glm::vec3 normal = geometry.normal(piece.shape.triangle, side);
    const auto corners = inner_corners(geometry, piece.shape, element.position);
    receiver.origins_.add(corners, normal, piece.area);
  }
  if (element.walled) receiver.views_.assign(element.piece_count, View::unknown);
  return receiver;
}

bool Receiver::open(const Geometry& geometry, const RayCaster& caster, std::uint32_t patch) const {
  if (views_[patch] == View::unknown) {
    const Patch& own = origins_.patch(patch);
    const bool open = std::ranges::all_of(
        std::array{own.corner, own.corner + own.edge1, own.corner + own.edge2}, [&](const glm::vec3& corner) {
          return mutually_visible(geometry, caster, middle_, {corner, own.frame.normal});
        });
    views_[patch] = open ? View::open : View::cut;
  }
  return views_[patch] == View::open;
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

std::uint64_t Receiver::identity() const {
  if (identity_ == 0) identity_ = make_identity();
  return identity_;
}

std::uint64_t Receiver::make_identity() const {
  std::uint64_t identity = mix(key(), walled() ? 1 : 0);
  const auto add = [&](float a, float b) {
    identity =
        mix(identity, std::uint64_t{std::bit_cast<std::uint32_t>(a)} << 32 | std::bit_cast<std::uint32_t>(b));
  };
  for (const Patch& patch : origins_.patches()) {
    add(patch.corner.x, patch.corner.y), add(patch.corner.z, patch.area_below);
    add(patch.edge1.x, patch.edge1.y), add(patch.edge1.z, patch.inverse_area);
    add(patch.edge2.x, patch.edge2.y), add(patch.edge2.z, 0.0f);
    add(patch.frame.normal.x, patch.frame.normal.y), add(patch.frame.normal.z, 0.0f);
  }
  return identity;
}

float Receiver::reach() const {
  float reach = 0.0f;
  for (const Patch& patch : origins_.patches()) {
    const glm::vec3 corner = patch.corner - middle_.position;
    reach = std::max(
        {reach, glm::length(corner), glm::length(corner + patch.edge1), glm::length(corner + patch.edge2)});
  }
  return reach;
}

}  // namespace relume
