// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/elements.h"
#include "precompute/geometry.h"
#include "precompute/mutual_visibility.h"
#include "precompute/ray_caster.h"

namespace relume {

/// Where the rays of one row start: spread by area over the pieces of an element, or at one point.
class Receiver {
 public:
  /// Origins of an element that walls run through or beside are those that its middle sees.
  static Receiver element(const SystemSurface& surface, const Element& element, Side side);
  static Receiver point(const SurfacePoint& at);

  /// Origin (on the surface, not lifted) and normal for u, v in [0, 1).
  SurfacePoint sample(const Geometry& geometry, float u, float v) const;

  /// Whether an origin belongs to this receiver.
  bool owns(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& origin) const {
    return !guarded_ || mutually_visible(geometry, caster, middle_, origin);
  }

  const SurfacePoint& middle() const { return middle_; }
  /// Of a circle of the receiver's area, m.
  float radius() const { return radius_; }
  /// The same place has the same key, whatever else is in the scene: seeds come from it.
  std::uint64_t key() const;

 private:
  SurfacePoint middle_;
  float radius_ = 0.0f;
  bool guarded_ = false;
  Side side_ = Side::front;
  std::span<const Piece> pieces_;
  std::vector<float> cumulative_area_;
};

}  // namespace relume
