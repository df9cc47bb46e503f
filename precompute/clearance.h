// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "precompute/charts.h"
#include "precompute/elements.h"

namespace relume {

/// Harmonic mean of the distances to what each element sees, m: over so much irradiance changes (G. Ward, F.
/// Rubinstein, R. Clear, A Ray Tracing Solution for Diffuse Interreflection, 1988). Small along creases,
/// contacts and the edges of occluders; infinite under an open sky. In the calling task arena.
std::vector<float> clearances(const Geometry& geometry, const RayCaster& caster,
                              const std::vector<Chart>& charts, const SystemSurface& surface);

/// Distance from a point to the nearest surface that it sees, in many directions, m. Infinite where it sees
/// none.
float free_radius(const RayCaster& caster, const glm::vec3& position);

}  // namespace relume
