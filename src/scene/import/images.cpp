// SPDX-License-Identifier: MIT
#include "scene/import/images.h"

#include <fmt/format.h>

#include <climits>
#include <memory>

#include "scene/import/import_error.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#include <stb_image.h>

namespace relume {
namespace {

struct StbDeleter {
  void operator()(void* pixels) const { stbi_image_free(pixels); }
};

const stbi_uc* stb_bytes(std::span<const std::byte> encoded) {
  return reinterpret_cast<const stbi_uc*>(encoded.data());
}

struct ImageSize {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

Result<ImageSize> checked_size(std::span<const std::byte> encoded, std::uint64_t max_pixels,
                               const std::string& file, const std::string& place, const char* expected) {
  int width = 0;
  int height = 0;
  int channels = 0;
  if (encoded.size() > INT_MAX ||
      stbi_info_from_memory(stb_bytes(encoded), static_cast<int>(encoded.size()), &width, &height,
                            &channels) == 0 ||
      width <= 0 || height <= 0) {
    return import_error(file, place, expected, fmt::format("{} bytes that are none", encoded.size()));
  }
  if (static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) > max_pixels) {
    return import_error(file, place, fmt::format("at most {} pixels", max_pixels),
                        fmt::format("{} x {}", width, height));
  }
  return ImageSize{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

}  // namespace

Result<SceneImage> decode_image(std::span<const std::byte> encoded, std::uint64_t max_pixels,
                                const std::string& file, const std::string& place) {
  const auto size = checked_size(encoded, max_pixels, file, place, "a PNG or JPEG image");
  if (!size) return tl::unexpected(size.error());
  int width = 0;
  int height = 0;
  int channels = 0;
  const std::unique_ptr<stbi_uc, StbDeleter> pixels(stbi_load_from_memory(
      stb_bytes(encoded), static_cast<int>(encoded.size()), &width, &height, &channels, STBI_rgb_alpha));
  if (!pixels) return import_error(file, place, "a whole PNG or JPEG image", stbi_failure_reason());
  SceneImage image{size->width, size->height, {}};
  image.rgba.assign(pixels.get(), pixels.get() + std::size_t{4} * size->width * size->height);
  return image;
}

Result<EquirectangularSky> decode_hdr(std::span<const std::byte> encoded, std::uint64_t max_pixels,
                                      const std::string& file) {
  if (encoded.size() > INT_MAX ||
      stbi_is_hdr_from_memory(stb_bytes(encoded), static_cast<int>(encoded.size())) == 0) {
    return import_error(file, "byte 0", "a Radiance .hdr image",
                        fmt::format("{} bytes that are none", encoded.size()));
  }
  const auto size = checked_size(encoded, max_pixels, file, "byte 0", "a Radiance .hdr image");
  if (!size) return tl::unexpected(size.error());
  int width = 0;
  int height = 0;
  int channels = 0;
  const std::unique_ptr<float, StbDeleter> pixels(stbi_loadf_from_memory(
      stb_bytes(encoded), static_cast<int>(encoded.size()), &width, &height, &channels, STBI_rgb));
  if (!pixels) return import_error(file, "byte 0", "a whole Radiance .hdr image", stbi_failure_reason());
  EquirectangularSky sky{size->width, size->height, {}};
  sky.radiance.resize(std::size_t{size->width} * size->height);
  for (std::size_t i = 0; i < sky.radiance.size(); ++i) {
    sky.radiance[i] = {pixels.get()[3 * i], pixels.get()[3 * i + 1], pixels.get()[3 * i + 2]};
  }
  return sky;
}

}  // namespace relume
