// SPDX-License-Identifier: MIT
#include "precompute/mutual_visibility.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

/// Lift for flat surfaces as a share of the distance.
constexpr float kFlatLift = 0.02f;

glm::vec3 lifted(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& p, float lift) {
  const glm::vec3 low = p.position + p.normal * geometry.offset;
  const glm::vec3 high = p.position + p.normal * lift;
  return lift > geometry.offset && !caster.occluded(low, high) ? high : low;
}

/// How far both of two points are lifted, m.
float lift_between(const Geometry& geometry, const SurfacePoint& a, const SurfacePoint& b) {
  const float half_angle_sine = std::sqrt(std::max(0.0f, 0.5f - 0.5f * glm::dot(a.normal, b.normal)));
  return std::max(geometry.offset,
                  glm::length(b.position - a.position) * (kFlatLift + 0.5f * half_angle_sine));
}

}  // namespace

float headroom(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& at, float most) {
  return caster.free_way(at.position + at.normal * geometry.offset, at.normal, most);
}

bool mutually_visible(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& a,
                      const SurfacePoint& b) {
  if (a.position == b.position) return true;
  const float lift = lift_between(geometry, a, b);
  return !caster.occluded(lifted(geometry, caster, a, lift), lifted(geometry, caster, b, lift));
}

bool mutually_visible(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& a,
                      float headroom_a, const SurfacePoint& b, float headroom_b) {
  if (a.position == b.position) return true;
  const float lift = lift_between(geometry, a, b);
  const auto end = [&](const SurfacePoint& p, float free) {
    return p.position + p.normal * (lift - geometry.offset <= free ? lift : geometry.offset);
  };
  return !caster.occluded(end(a, headroom_a), end(b, headroom_b));
}

}  // namespace relume
