// SPDX-License-Identifier: MIT
//
// What rays and surfaces ask of triangles that are not opaque (core/opacity.h).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/model.h"

namespace relume {

/// Seed of a ray's coins: its origin and direction, bit by bit.
std::uint64_t ray_key(const glm::vec3& origin, const glm::vec3& direction);

class TriangleOpacity {
 public:
  TriangleOpacity() = default;
  /// Over `triangles`, all of the scene's; what `opacity` does not list is opaque.
  TriangleOpacity(Opacity opacity, std::span<const glm::vec3> positions,
                  std::span<const std::array<std::uint32_t, 3>> triangles);

  const Opacity& stored() const { return opacity_; }
  bool any() const { return !opacity_.triangles.empty(); }
  bool opaque(std::uint32_t triangle) const { return !any() || entry_[triangle] == kNone; }
  /// Rays need not be told of it at all.
  bool never_solid(std::uint32_t triangle) const {
    return !opaque(triangle) && relume::never_solid(opacity_, opacity_.triangles[entry_[triangle]]);
  }

  /// The share of the light that the triangle stops at (u, v), 0..1.
  float at(std::uint32_t triangle, float u, float v) const {
    return opaque(triangle) ? 1.0f : opacity_at(opacity_, opacity_.triangles[entry_[triangle]], u, v);
  }

  /// Mean over the part of the triangle with these corners (as SurfacePiece): which share of its area is
  /// solid. Exact where the part covers few texels, and vertices agree in alpha.
  double mean(std::uint32_t triangle, const std::array<glm::vec2, 3>& corners) const;

  /// Whether a ray passes the triangle at (u, v): a coin of 1 - opacity that depends on the ray and on where
  /// the corners of the triangle are, and on nothing else. Triangles with the same corners toss the same
  /// coin: they are one sheet.
  bool passes(std::uint32_t triangle, float u, float v, std::uint64_t key) const;

  /// Whether an earlier triangle with the same corners is not opaque either: of a sheet, one face counts.
  bool repeats(std::uint32_t triangle) const { return !opaque(triangle) && repeats_[entry_[triangle]]; }

 private:
  Opacity opacity_;
  std::vector<std::uint32_t> entry_;  ///< per triangle of the scene: index into the listed ones, or kNone
  std::vector<std::uint64_t> sheet_;  ///< per listed triangle: key of its corners, in any order
  std::vector<bool> repeats_;         ///< per listed triangle
};

}  // namespace relume
