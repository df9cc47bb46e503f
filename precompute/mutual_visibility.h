// SPDX-License-Identifier: MIT
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "precompute/geometry.h"
#include "precompute/ray_caster.h"

namespace relume {

/// A point on a surface and the unit normal of the side that is meant.
struct SurfacePoint {
  glm::vec3 position{0.0f};
  glm::vec3 normal{0.0f};
};

/// Whether two nearby points of a surface belong to the same side of all walls: both are lifted, by more the
/// further apart they are and the more the surface bends between them (so that a convex surface does not hide
/// its own neighbourhood), unless something close above is in the way, and the segment between them is free.
bool mutually_visible(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& a,
                      const SurfacePoint& b);

/// How far one can go straight up from `offset` above a surface, m, at most `most`.
float headroom(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& at, float most);

/// Points whose normals are no more than 60 degrees apart are lifted by at most this share of their distance,
/// or by Geometry::offset.
inline constexpr float kMostLift = 0.3f;

/// mutually_visible() of points above which so much is free: for whoever asks about a point again and again.
bool mutually_visible(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& a,
                      float headroom_a, const SurfacePoint& b, float headroom_b);

/// All that the answer depends on lies within this many times their distance of the points.
inline constexpr float kLiftReach = 1.6f;

}  // namespace relume
