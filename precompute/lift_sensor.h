// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>

#include "precompute/geometry.h"
#include "precompute/mutual_visibility.h"
#include "precompute/ray_caster.h"

namespace relume {

/// Where a sensor measures: lifted off a surface that it lies on or just under (1e-4 of the scene's
/// diagonal); in free space it stays. `position` is in world space, the result about geometry.origin. Uses
/// bounds, origin and offset of the geometry.
SurfacePoint lift_sensor(const Geometry& geometry, const RayCaster& caster, const glm::dvec3& position,
                         const glm::dvec3& normal);

}  // namespace relume
