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

}  // namespace

bool mutually_visible(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& a,
                      const SurfacePoint& b) {
  const float distance = glm::length(b.position - a.position);
  if (distance == 0.0f) return true;
  const float half_angle_sine = std::sqrt(std::max(0.0f, 0.5f - 0.5f * glm::dot(a.normal, b.normal)));
  const float lift = std::max(geometry.offset, distance * (kFlatLift + 0.5f * half_angle_sine));
  return !caster.occluded(lifted(geometry, caster, a, lift), lifted(geometry, caster, b, lift));
}

}  // namespace relume
