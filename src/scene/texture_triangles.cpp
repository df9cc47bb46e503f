// SPDX-License-Identifier: MIT
#include "scene/texture_triangles.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

/// What an image of this material would be placed by, if it may show one.
std::optional<TextureUse> placement(const SceneMaterial& material, bool possible_emitter) {
  if (material.emission_texture) return material.emission_texture;
  if (material.base_color_texture) return material.base_color_texture;
  return possible_emitter ? std::optional(TextureUse{}) : std::nullopt;
}

glm::vec2 placed(const TextureUse& use, const glm::vec2& uv) {
  const auto bounded = [](double t) { return std::isfinite(t) ? float(std::clamp(t, -1e9, 1e9)) : 0.0f; };
  const glm::dvec3 at = use.transform * glm::dvec3(uv, 1.0);
  return {bounded(at.x), bounded(at.y)};
}

}  // namespace

std::vector<TextureTriangle> texture_triangles(const Scene& scene,
                                               const std::vector<bool>& possible_emitters) {
  std::vector<TextureTriangle> listed;
  for (const SceneSurface& surface : scene.surfaces) {
    const std::optional<TextureUse> use =
        placement(scene.materials[surface.material], possible_emitters[surface.material]);
    if (!use || !(use->uv_set == 0 ? surface.has_uv0 : surface.has_uv1)) continue;
    const auto& uv = use->uv_set == 0 ? scene.vertices.uv0 : scene.vertices.uv1;
    for (std::uint32_t i = 0; i < surface.triangle_count; ++i) {
      TextureTriangle triangle{surface.first_triangle + i, {}};
      for (std::size_t k = 0; k < 3; ++k)
        triangle.corners[k] = placed(*use, uv[scene.triangles[triangle.triangle][k]]);
      listed.push_back(triangle);
    }
  }
  return listed;
}

}  // namespace relume
