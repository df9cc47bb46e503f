// SPDX-License-Identifier: MIT
//
// Charts: parts of surface laid out flat in lumels. Either a node's own TEXCOORD_1, or planar charts grown
// over neighbouring triangles of one node and material whose normals agree.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "core/model.h"
#include "precompute/geometry.h"
#include "scene/scene.h"

namespace relume {

/// Twice the area of the triangle (0, a, b), positive when that is counter-clockwise.
inline double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

struct Chart {
  std::uint32_t node = 0;
  Side side = Side::front;
  std::uint32_t uv_set = kNone;               ///< 1: TEXCOORD_1
  glm::vec2 uv_scale{1.0f}, uv_offset{0.0f};  ///< uv_set 1: corner = uv * uv_scale + uv_offset
  std::uint32_t width = 0, height = 0;        ///< lumels
  std::vector<std::uint32_t> triangles;
  std::vector<std::array<glm::vec2, 3>>
      corners;  ///< per triangle, in lumels from the chart's own corner, within [0, width] x [0, height]
};

/// Texel size (m) of every node: its extras', else `texel_size`.
std::vector<double> texel_sizes(const Scene& scene, double texel_size);

/// Charts of all nodes that bounce or receive (extras.relume.receiver other than "none"), per side.
/// Deterministic order: by node, then by first triangle. A TEXCOORD_1 that leaves [0, 1], overlaps itself or
/// has no area is not used; `warnings` says so by name.
std::vector<Chart> make_charts(const Scene& scene, const Geometry& geometry, double texel_size,
                               std::vector<std::string>& warnings);

/// Planar charts of the triangles [first, last) of one node.
std::vector<Chart> planar_charts(const Geometry& geometry, std::uint32_t first, std::uint32_t last,
                                 double texel_size);

}  // namespace relume
