// SPDX-License-Identifier: MIT
//
// How much light the triangles of a scene stop: alpha MASK, alpha BLEND and transmission, as plain arrays
// that a ray tracer on either side can walk. Triangles that are not listed are opaque.
//
// The alpha of a point is the third coordinate of its corners, interpolated, times its texel / 255 (the
// nearest texel; 1 where there is no image). Its opacity, the share of the light that it stops, is `solid`
// where mask alpha reaches the cutoff, else 0; and alpha x `solid` where it blends.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace relume {

enum class WrapMode : std::uint32_t { repeat, mirrored_repeat, clamp_to_edge };

enum class OpacityRule : std::uint32_t { mask, blend };

/// What all triangles of one material share. Stored.
struct OpacityMap {
  OpacityRule rule = OpacityRule::blend;
  float cutoff = 0.5f;                  ///< of a mask
  float solid = 1.0f;                   ///< 0..1: 1 - transmission
  std::uint32_t width = 0, height = 0;  ///< texels; both 0: no image
  WrapMode wrap_s = WrapMode::repeat, wrap_t = WrapMode::repeat;
  std::uint32_t first_texel = 0;  ///< texel (x, y) is Opacity::texels[first_texel + y * width + x]
};
static_assert(sizeof(OpacityMap) == 32);

/// A triangle that is not opaque. Stored.
struct OpacityTriangle {
  std::uint32_t triangle = 0;  ///< index into the triangles of the scene
  std::uint32_t map = 0;
  /// Texture coordinates, after any transform, and alpha (factor x vertex colour, 0..1) of each corner.
  std::array<glm::vec3, 3> corners{};
};
static_assert(sizeof(OpacityTriangle) == 44);

struct Opacity {
  std::vector<OpacityMap> maps;
  std::vector<std::uint8_t> texels;        ///< alpha; maps of one image share them
  std::vector<OpacityTriangle> triangles;  ///< ascending by triangle
};

/// The texel that a texture coordinate (1 = the whole image) falls into.
inline std::uint32_t wrapped_texel(double t, WrapMode mode, std::uint32_t size) {
  if (!std::isfinite(t)) return 0;
  if (mode == WrapMode::repeat) t -= std::floor(t);
  if (mode == WrapMode::mirrored_repeat) {
    t -= 2.0 * std::floor(t / 2.0);
    if (t > 1.0) t = 2.0 - t;
  }
  return std::min(static_cast<std::uint32_t>(std::clamp(t, 0.0, 1.0) * size), size - 1);
}

/// Of a point whose alpha is known.
inline float opacity_of_alpha(const OpacityMap& map, float alpha) {
  if (map.rule == OpacityRule::blend) return alpha * map.solid;
  return alpha >= map.cutoff ? map.solid : 0.0f;
}

/// Opacity at barycentric (u, v), as SurfacePiece.
inline float opacity_at(const Opacity& opacity, const OpacityTriangle& triangle, float u, float v) {
  const OpacityMap& map = opacity.maps[triangle.map];
  const glm::vec3 at = triangle.corners[0] + u * (triangle.corners[1] - triangle.corners[0]) +
                       v * (triangle.corners[2] - triangle.corners[0]);
  if (map.width == 0) return opacity_of_alpha(map, at.z);
  const std::size_t x = wrapped_texel(at.x, map.wrap_s, map.width),
                    y = wrapped_texel(at.y, map.wrap_t, map.height);
  return opacity_of_alpha(map, at.z * (float(opacity.texels[map.first_texel + y * map.width + x]) / 255.0f));
}

/// Whether no point of the triangle stops any light, whatever its texels.
inline bool never_solid(const Opacity& opacity, const OpacityTriangle& triangle) {
  const auto& c = triangle.corners;
  return opacity_of_alpha(opacity.maps[triangle.map], std::max({c[0].z, c[1].z, c[2].z})) <= 0.0f;
}

}  // namespace relume
