// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>

#include "scene/import/primitives.h"
#include "scene/scene.h"

namespace relume {

/// Beyond this coordinate (m), Embree drops triangles without a word.
inline constexpr double kMaxCoordinate = 1e18;

/// Appends one primitive under a transform as one surface. Corners change places where the transform mirrors,
/// so that fronts stay fronts.
void append_surface(const MeshPrimitive& primitive, const glm::dmat4& world, std::uint32_t node,
                    std::uint32_t material, Scene& scene);

/// Takes out triangles with a coordinate that is not finite or beyond kMaxCoordinate, that a transform made
/// flat, or that have the same corners in the same sense as an earlier one; then vertices and surfaces that
/// nothing uses. Counts them in the scene.
void drop_bad_triangles(Scene& scene);

}  // namespace relume
