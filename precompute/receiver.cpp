// SPDX-License-Identifier: MIT
#include "precompute/receiver.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "precompute/sampling.h"

namespace relume {

Receiver Receiver::element(const SystemSurface& surface, const Element& element, Side side) {
  Receiver receiver;
  receiver.middle_ = {element.position, element.normal};
  receiver.radius_ = std::sqrt(element.area / 3.14159265f);
  receiver.guarded_ = element.walled;
  receiver.side_ = side;
  receiver.pieces_ = std::span(surface.pieces).subspan(element.first_piece, element.piece_count);
  float sum = 0.0f;
  for (const Piece& piece : receiver.pieces_) receiver.cumulative_area_.push_back(sum += piece.area);
  return receiver;
}

Receiver Receiver::point(const SurfacePoint& at) {
  Receiver receiver;
  receiver.middle_ = at;
  return receiver;
}

SurfacePoint Receiver::sample(const Geometry& geometry, float u, float v) const {
  if (pieces_.empty()) return middle_;
  const float target = u * cumulative_area_.back();
  const auto found = std::upper_bound(cumulative_area_.begin(), cumulative_area_.end() - 1, target);
  const auto index = std::size_t(found - cumulative_area_.begin());
  const float below = index > 0 ? cumulative_area_[index - 1] : 0.0f;
  const Piece& piece = pieces_[index];
  const float rest =
      std::clamp((target - below) / std::max(cumulative_area_[index] - below, 1e-30f), 0.0f, 0.99999994f);
  const glm::vec2 at = triangle_point(rest, v);
  const auto& c = piece.shape.corners;
  const glm::vec2 uv = c[0] * (1.0f - at.x - at.y) + c[1] * at.x + c[2] * at.y;
  const glm::vec3 point = geometry.point(piece.shape.triangle, uv.x, uv.y);
  // Away from the border by as much as rays are lifted: an origin in the edge of a room would start behind
  // the other wall.
  const glm::vec3 inward = middle_.position - point;
  const float distance = glm::length(inward);
  const float step = distance > 0.0f ? std::min(1.0f, 2.0f * geometry.offset / distance) : 0.0f;
  return {point + inward * step, geometry.normal(piece.shape.triangle, side_)};
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
