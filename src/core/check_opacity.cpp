// SPDX-License-Identifier: MIT
#include "core/model_checks.h"

namespace relume {
namespace {

bool share(float value) {
  return value >= 0.0f && value <= 1.0f;
}

Result<void> check_map(const Opacity& opacity, std::size_t index) {
  const OpacityMap& map = opacity.maps[index];
  if (std::uint32_t(map.rule) > 1 || std::uint32_t(map.wrap_s) > 2 || std::uint32_t(map.wrap_t) > 2) {
    return broken_model("opacity map {}: expected rule 0 or 1 and wrap modes 0, 1 or 2, found {}, {} and {}",
                        index, std::uint32_t(map.rule), std::uint32_t(map.wrap_s), std::uint32_t(map.wrap_t));
  }
  if (!std::isfinite(map.cutoff) || map.cutoff < 0.0f || !share(map.solid)) {
    return broken_model(
        "opacity map {}: expected a finite cutoff >= 0 and a solid share from 0 to 1, found {} and {}", index,
        map.cutoff, map.solid);
  }
  const std::uint64_t end = map.first_texel + std::uint64_t{map.width} * map.height;
  if ((map.width == 0) != (map.height == 0) || end > opacity.texels.size()) {
    return broken_model("opacity map {}: expected {} x {} texels from texel {} on, found {} texels in all",
                        index, map.width, map.height, map.first_texel, opacity.texels.size());
  }
  return {};
}

Result<void> check_corners(const OpacityTriangle& triangle, std::size_t index) {
  for (const glm::vec3& corner : triangle.corners) {
    if (finite(corner) && share(corner.z)) continue;
    return broken_model("opacity of triangle {}: expected finite texture coordinates and alpha from 0 to 1",
                        index);
  }
  return {};
}

}  // namespace

Result<void> check_opacity(const Opacity& opacity, std::size_t triangles) {
  for (std::size_t index = 0; index < opacity.maps.size(); ++index) {
    if (auto checked = check_map(opacity, index); !checked) return checked;
  }
  std::uint64_t next = 0;
  for (const OpacityTriangle& listed : opacity.triangles) {
    if (listed.triangle >= triangles || listed.triangle < next) {
      return broken_model("opacity: expected ascending triangles below {}, found {}", triangles,
                          listed.triangle);
    }
    next = std::uint64_t{listed.triangle} + 1;
    if (listed.map >= opacity.maps.size()) {
      return broken_model("opacity of triangle {}: expected a map below {}, found {}", listed.triangle,
                          opacity.maps.size(), listed.map);
    }
    if (auto checked = check_corners(listed, listed.triangle); !checked) return checked;
  }
  return {};
}

Result<void> check_texture(const std::vector<TextureTriangle>& texture, std::size_t triangles) {
  std::uint64_t next = 0;
  for (const TextureTriangle& listed : texture) {
    if (listed.triangle >= triangles || listed.triangle < next) {
      return broken_model("texture coordinates: expected ascending triangles below {}, found {}", triangles,
                          listed.triangle);
    }
    next = std::uint64_t{listed.triangle} + 1;
    for (const glm::vec2& corner : listed.corners) {
      if (finite(corner)) continue;
      return broken_model("texture coordinates of triangle {}: expected finite numbers", listed.triangle);
    }
  }
  return {};
}

}  // namespace relume
