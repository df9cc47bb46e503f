// SPDX-License-Identifier: MIT
//
// Panes and checkerboards for built scenes.
#pragma once

#include "support/scene_builder.h"

namespace relume::test {

/// A material of two sides that stops `alpha` of the light.
inline std::uint32_t blend_material(SceneBuilder& builder, const Rgb& albedo, double alpha) {
  const std::uint32_t index = builder.material("pane", albedo, Rgb(0.0), /*double_sided=*/true);
  builder.scene().materials[index].alpha_mode = AlphaMode::blend;
  builder.scene().materials[index].alpha = alpha;
  return index;
}

/// A material of two sides whose texture, repeated, is solid on every other texel of 2 x 2.
inline std::uint32_t checker_material(SceneBuilder& builder, const Rgb& albedo) {
  const std::uint32_t index = builder.material("checkers", albedo, Rgb(0.0), /*double_sided=*/true);
  SceneMaterial& material = builder.scene().materials[index];
  material.alpha_mode = AlphaMode::mask;
  material.base_color_texture = TextureUse{};
  material.base_color_texture->image = std::uint32_t(builder.scene().images.size());
  SceneImage image{2, 2, std::vector<std::uint8_t>(16, 255)};
  image.rgba[7] = image.rgba[11] = 0;
  builder.scene().images.push_back(image);
  return index;
}

/// Spreads texture coordinates over the quad that was added last: (0, 0) to (s, t).
inline void map_last_quad(SceneBuilder& builder, float s, float t) {
  auto& uv = builder.scene().vertices.uv0;
  const std::size_t first = uv.size() - 4;
  uv[first] = {0, 0}, uv[first + 1] = {s, 0}, uv[first + 2] = {s, t}, uv[first + 3] = {0, t};
  builder.scene().surfaces.back().has_uv0 = true;
}

}  // namespace relume::test
