// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "core/model.h"

namespace relume {

/// A point of the occluders and the side from which it is seen.
struct SeenPoint {
  std::uint32_t triangle = 0;
  Side side = Side::front;
  glm::vec2 barycentric{0.0f};  ///< as SurfacePiece
};

/// The point of `triangle` that a ray along `direction` met, with the side that it came from.
SeenPoint seen_point(const Model& model, std::uint32_t triangle, const glm::vec2& barycentric,
                     const glm::vec3& direction);

/// Whether the point is on the back of a single-sided material, which glTF renderers do not draw.
bool hidden_back(const Model& model, const SeenPoint& point);

/// Where a point lies in the lightmap of its system.
struct LightmapPlace {
  std::uint32_t system = 0;
  glm::vec2 texel{0.0f};  ///< in lumels; the middle of lumel (x, y) is (x + 0.5, y + 0.5)
};

/// Nothing for hidden backs and surfaces without a lightmap.
std::optional<LightmapPlace> lightmap_place(const Model& model, const SeenPoint& point);

/// Corner k of a triangle of the occluders, relative to Model::origin.
inline const glm::vec3& occluder_corner(const Occluders& occluders, std::uint32_t triangle, int k) {
  return occluders.positions[occluders.triangles[triangle][k]];
}

}  // namespace relume
