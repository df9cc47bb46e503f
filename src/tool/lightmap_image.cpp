// SPDX-License-Identifier: MIT
#include "tool/lightmap_image.h"

namespace relume {

ColorImage lightmap_image(const System& system, std::span<const Rgb> lumel_values) {
  ColorImage image(system.lightmap_width, system.lightmap_height);
  const LightmapTexels list = lightmap_texels(system);
  for (std::size_t i = 0; i < list.texels.size(); ++i) {
    const std::uint32_t first = list.first_lumel[i], end = list.first_lumel[i + 1];
    Rgb sum(0.0);
    for (std::uint32_t k = first; k < end; ++k) sum += lumel_values[list.lumels[k]];
    image.at(list.texels[i].x, list.texels[i].y) = glm::vec3(sum / double(end - first));
  }
  return image;
}

}  // namespace relume
