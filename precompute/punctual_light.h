// SPDX-License-Identifier: MIT
//
// What point, spot and directional lights give when nothing is in between (core/light.h has the formulas).
#pragma once

#include <glm/vec3.hpp>

#include "core/light.h"
#include "core/light_patches.h"
#include "core/quantities.h"

namespace relume {

/// Solid angle (sr) of a triangle seen from a point; 0 when the point lies in its plane (A. van Oosterom, J.
/// Strackee, The Solid Angle of a Plane Triangle, 1983).
double solid_angle(const glm::dvec3& from, const TriangleCorners& corners);

/// The share of its intensity that a point or spot light sends towards `point`: cone and range.
double intensity_share(const Light& light, const glm::dvec3& point);

/// Whether the cone and range of a point or spot light may reach the triangle; directional lights reach
/// everything.
bool may_reach(const Light& light, const TriangleCorners& corners);

/// Irradiance (lm/m2) at a point with a unit normal. 0 at the light itself.
Rgb irradiance_at_point(const Light& light, const glm::dvec3& point, const glm::dvec3& normal);

}  // namespace relume
