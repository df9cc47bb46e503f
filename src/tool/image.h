// SPDX-License-Identifier: MIT
//
// Pictures in memory and as bytes of a file. Row 0 is the top, as in PNG, EXR and glTF textures.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "core/quantities.h"
#include "core/result.h"

namespace relume {

/// Linear Rec.709, any unit.
struct ColorImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<glm::vec3> pixels;  ///< row by row

  ColorImage() = default;
  ColorImage(std::uint32_t w, std::uint32_t h) : width(w), height(h), pixels(std::size_t{w} * h) {}
  glm::vec3& at(std::uint32_t x, std::uint32_t y) { return pixels[std::size_t{y} * width + x]; }
  const glm::vec3& at(std::uint32_t x, std::uint32_t y) const { return pixels[std::size_t{y} * width + x]; }
};

/// sRGB as shown.
using ByteColor = std::array<std::uint8_t, 3>;
struct ByteImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<ByteColor> pixels;  ///< row by row

  ByteImage() = default;
  ByteImage(std::uint32_t w, std::uint32_t h) : width(w), height(h), pixels(std::size_t{w} * h) {}
};

/// sRGB bytes of a linear colour, clamped to 0..1.
ByteColor srgb_bytes(const Rgb& linear);

ByteImage srgb_image(const ColorImage& linear);

Result<std::vector<std::byte>> encode_png(const ByteImage& image);

/// The largest half-precision number: values of an EXR are clamped to it, and to its negative.
inline constexpr float kLargestHalf = 65504.0f;

/// Half precision, channels B, G, R, ZIP-compressed.
Result<std::vector<std::byte>> encode_exr(const ColorImage& image);

/// Single precision, channels A, B, G, R, ZIP-compressed. `alpha`: per pixel.
Result<std::vector<std::byte>> encode_exr(const ColorImage& image, std::vector<float> alpha);

}  // namespace relume
