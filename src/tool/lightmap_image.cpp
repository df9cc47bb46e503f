// SPDX-License-Identifier: MIT
#include "tool/lightmap_image.h"

#include <optional>

namespace relume {
namespace {

enum class Texel : std::uint8_t { outside, invalid, filled };

struct Canvas {
  ColorImage image;
  std::vector<Texel> texels;
};

Canvas draw_lumels(const System& system, std::span<const Rgb> lumel_values) {
  Canvas canvas{ColorImage(system.lightmap_width, system.lightmap_height), {}};
  canvas.texels.resize(canvas.image.pixels.size(), Texel::outside);
  for (std::size_t i = 0; i < system.lumels.size(); ++i) {
    const Lumel& lumel = system.lumels[i];
    const std::size_t texel = std::size_t{lumel.y} * system.lightmap_width + lumel.x;
    const bool valid = (lumel.flags & kLumelInvalid) == 0;
    canvas.texels[texel] = valid ? Texel::filled : Texel::invalid;
    if (valid) canvas.image.pixels[texel] = glm::vec3(lumel_values[i]);
  }
  return canvas;
}

struct Filling {
  std::size_t texel;
  glm::vec3 color;
};

/// Mean of the filled ones among the eight neighbours, if there are any.
std::optional<glm::vec3> mean_of_neighbors(const Canvas& canvas, std::uint32_t x, std::uint32_t y) {
  const std::uint32_t width = canvas.image.width;
  glm::vec3 sum(0.0f);
  float count = 0.0f;
  for (std::uint32_t ny = y > 0 ? y - 1 : 0; ny <= y + 1 && ny < canvas.image.height; ++ny) {
    for (std::uint32_t nx = x > 0 ? x - 1 : 0; nx <= x + 1 && nx < width; ++nx) {
      const std::size_t neighbor = std::size_t{ny} * width + nx;
      if (canvas.texels[neighbor] != Texel::filled) continue;
      sum += canvas.image.pixels[neighbor];
      count += 1.0f;
    }
  }
  return count > 0.0f ? std::optional(sum / count) : std::nullopt;
}

/// What the next ring adds, all from texels that were filled before it.
std::vector<Filling> next_ring(const Canvas& canvas, bool only_invalid) {
  std::vector<Filling> ring;
  for (std::uint32_t y = 0; y < canvas.image.height; ++y) {
    for (std::uint32_t x = 0; x < canvas.image.width; ++x) {
      const std::size_t texel = std::size_t{y} * canvas.image.width + x;
      const Texel state = canvas.texels[texel];
      if (state == Texel::filled || (only_invalid && state != Texel::invalid)) continue;
      if (const auto mean = mean_of_neighbors(canvas, x, y)) ring.push_back({texel, *mean});
    }
  }
  return ring;
}

}  // namespace

ColorImage lightmap_image(const System& system, std::span<const Rgb> lumel_values) {
  Canvas canvas = draw_lumels(system, lumel_values);
  for (int ring = 0;; ++ring) {
    const std::vector<Filling> fillings = next_ring(canvas, ring >= kDilation);
    if (fillings.empty()) break;
    for (const Filling& filling : fillings) {
      canvas.image.pixels[filling.texel] = filling.color;
      canvas.texels[filling.texel] = Texel::filled;
    }
  }
  return std::move(canvas.image);
}

}  // namespace relume
