// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/area_sampler.h"
#include "precompute/elements.h"
#include "precompute/geometry.h"
#include "precompute/mutual_visibility.h"
#include "precompute/ray_caster.h"

namespace relume {

/// Where the rays of one row start: spread by area over the pieces of an element, or at one point.
class Receiver {
 public:
  /// Origins lie inside the border of the element by as much as rays are lifted: one in the edge of a room
  /// would start behind the other wall. Those of an element that walls run through or beside are what its
  /// middle sees.
  static Receiver element(const Geometry& geometry, const SystemSurface& surface, const Element& element,
                          Side side);
  static Receiver point(const SurfacePoint& at);

  /// Where origins are drawn from; on the surface, not lifted.
  const AreaSampler& origins() const { return origins_; }

  /// Whether an origin belongs to this receiver. Not thread-safe.
  bool owns(const Geometry& geometry, const RayCaster& caster, const PointLanes& origins,
            std::size_t lane) const {
    if (views_.empty() || open(geometry, caster, origins.patch[lane])) return true;
    const glm::vec3 position(origins.x[lane], origins.y[lane], origins.z[lane]);
    return mutually_visible(geometry, caster, middle_,
                            {position, origins_.patch(origins.patch[lane]).frame.normal});
  }

  const SurfacePoint& middle() const { return middle_; }
  /// Of a circle of the receiver's area, m.
  float radius() const { return radius_; }
  /// The same place has the same key, whatever else is in the scene: seeds come from it.
  std::uint64_t key() const;
  /// The key, and everything else that its rays start from: with the same identity (and the same walls
  /// nearby, where it is walled) they are the same rays. Not thread-safe.
  std::uint64_t identity() const;
  /// Whether a wall may run through it.
  bool walled() const { return !views_.empty(); }
  /// No origin is further from the middle, m.
  float reach() const;

 private:
  SurfacePoint middle_;
  float radius_ = 0.0f;
  AreaSampler origins_;
  /// Whether the middle sees the corners of a patch, so that no wall cuts it.
  bool open(const Geometry& geometry, const RayCaster& caster, std::uint32_t patch) const;
  enum class View : std::uint8_t { unknown, open, cut };
  std::uint64_t make_identity() const;
  mutable std::vector<View> views_;     ///< per patch, once somebody asks; empty: all are open
  mutable std::uint64_t identity_ = 0;  ///< once somebody asks
};

}  // namespace relume
