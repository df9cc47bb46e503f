// SPDX-License-Identifier: MIT
#include "tool/image.h"

#include <stb_image_write.h>
#include <tinyexr.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>

namespace relume {
namespace {

struct FreeMemory {
  void operator()(unsigned char* memory) const { std::free(memory); }
};

void append_bytes(void* context, void* data, int size) {
  auto& bytes = *static_cast<std::vector<std::byte>*>(context);
  const auto* first = static_cast<const std::byte*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

std::uint8_t srgb_byte(double linear) {
  const double clamped = std::clamp(linear, 0.0, 1.0);
  const double coded = clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * std::pow(clamped, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(255.0 * coded + 0.5);
}

struct ExrPlane {
  char name = 'R';
  std::vector<float> values;
};

/// Red, green and blue of an image in the alphabetical order that EXR readers expect.
std::vector<ExrPlane> planes_bgr(const ColorImage& image, float largest) {
  std::vector<ExrPlane> planes;
  for (int c = 2; c >= 0; --c) {
    ExrPlane& plane = planes.emplace_back();
    plane.name = "RGB"[c];
    plane.values.reserve(image.pixels.size());
    for (const glm::vec3& pixel : image.pixels)
      plane.values.push_back(std::clamp(pixel[c], -largest, largest));
  }
  return planes;
}

/// `planes` in the alphabetical order of their names.
Result<std::vector<std::byte>> encode_planes(std::vector<ExrPlane> planes, std::uint32_t width,
                                             std::uint32_t height, int pixel_type) {
  std::vector<unsigned char*> plane_bytes;
  std::vector<EXRChannelInfo> channels(planes.size());
  for (std::size_t c = 0; c < planes.size(); ++c) {
    plane_bytes.push_back(reinterpret_cast<unsigned char*>(planes[c].values.data()));
    channels[c].name[0] = planes[c].name;
  }
  std::vector<int> stored(planes.size(), TINYEXR_PIXELTYPE_FLOAT), wanted(planes.size(), pixel_type);

  EXRHeader header;
  InitEXRHeader(&header);
  header.num_channels = static_cast<int>(planes.size());
  header.channels = channels.data();
  header.pixel_types = stored.data();
  header.requested_pixel_types = wanted.data();
  header.compression_type = TINYEXR_COMPRESSIONTYPE_ZIP;
  EXRImage exr;
  InitEXRImage(&exr);
  exr.num_channels = header.num_channels;
  exr.images = plane_bytes.data();
  exr.width = static_cast<int>(width);
  exr.height = static_cast<int>(height);

  unsigned char* memory = nullptr;
  const char* message = nullptr;
  const std::size_t size = SaveEXRImageToMemory(&exr, &header, &memory, &message);
  const std::unique_ptr<unsigned char, FreeMemory> owner(memory);
  if (size == 0) {
    const std::string reason = message ? message : "no reason given";
    FreeEXRErrorMessage(message);
    return fail(ErrorCode::out_of_memory, "An EXR image could not be encoded: " + reason + ".");
  }
  std::vector<std::byte> bytes(size);
  std::memcpy(bytes.data(), memory, size);
  return bytes;
}

}  // namespace

ByteColor srgb_bytes(const Rgb& linear) {
  return {srgb_byte(linear.x), srgb_byte(linear.y), srgb_byte(linear.z)};
}

ByteImage srgb_image(const ColorImage& linear) {
  ByteImage image(linear.width, linear.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = srgb_bytes(Rgb(linear.pixels[i]));
  return image;
}

Result<std::vector<std::byte>> encode_png(const ByteImage& image) {
  std::vector<std::byte> bytes;
  const int width = static_cast<int>(image.width);
  const int height = static_cast<int>(image.height);
  if (!stbi_write_png_to_func(append_bytes, &bytes, width, height, 3, image.pixels.data(), 3 * width)) {
    return fail(ErrorCode::out_of_memory, "A PNG of " + std::to_string(width) + " x " +
                                              std::to_string(height) +
                                              " pixels could not be encoded: out of memory.");
  }
  return bytes;
}

Result<std::vector<std::byte>> encode_exr(const ColorImage& image) {
  return encode_planes(planes_bgr(image, kLargestHalf), image.width, image.height, TINYEXR_PIXELTYPE_HALF);
}

Result<std::vector<std::byte>> encode_exr(const ColorImage& image, std::vector<float> alpha) {
  std::vector<ExrPlane> planes = planes_bgr(image, std::numeric_limits<float>::max());
  planes.insert(planes.begin(), {'A', std::move(alpha)});
  return encode_planes(std::move(planes), image.width, image.height, TINYEXR_PIXELTYPE_FLOAT);
}

}  // namespace relume
