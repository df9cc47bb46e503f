// SPDX-License-Identifier: MIT
//
// Triangle meshes of simple bodies, with normals, counter-clockwise seen from where the normal points.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scene/write_glb.h"

namespace relume {

/// Where the fronts of a closed body look.
enum class Facing { outward, inward };

/// A parallelogram with corners a, a + u, a + u + v, a + v; its front is where u x v points.
void append_quad(GlbPrimitive& mesh, const glm::dvec3& a, const glm::dvec3& u, const glm::dvec3& v);

/// A parallelogram with a rectangular hole, without T-junctions on the hole. The hole is `low` to `high` in
/// fractions of u and v.
void append_quad_with_hole(GlbPrimitive& mesh, const glm::dvec3& a, const glm::dvec3& u, const glm::dvec3& v,
                           const glm::dvec2& low, const glm::dvec2& high);

/// Faces of a box, or'ed.
enum BoxFaces : std::uint32_t {
  kLeft = 1u,    ///< -X
  kRight = 2u,   ///< +X
  kBottom = 4u,  ///< -Y
  kTop = 8u,     ///< +Y
  kBack = 16u,   ///< -Z
  kFront = 32u,  ///< +Z
  kAllFaces = 63u,
  kStandingFaces = kAllFaces & ~kBottom,  ///< of a box that stands on something
};
void append_box(GlbPrimitive& mesh, const glm::dvec3& low, const glm::dvec3& high,
                std::uint32_t faces = kAllFaces, Facing facing = Facing::outward);

/// A surface of revolution around a vertical axis through `foot`. `profile(t)` is (radius, height) for t from
/// 0 to 1, going up the outside.
void append_revolved(GlbPrimitive& mesh, const glm::dvec3& foot, std::uint32_t rings, std::uint32_t segments,
                     const std::function<glm::dvec2(double)>& profile, Facing facing = Facing::outward);

/// The part of a sphere between two polar angles (radians, from +Y). Vertices lie on the sphere.
void append_sphere(GlbPrimitive& mesh, const glm::dvec3& center, double radius, double from_angle,
                   double to_angle, std::uint32_t rings, std::uint32_t segments,
                   Facing facing = Facing::outward);

}  // namespace relume
