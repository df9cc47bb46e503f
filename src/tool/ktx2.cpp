// SPDX-License-Identifier: MIT
#include "tool/ktx2.h"

#include <vulkan/vulkan_core.h>

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string_view>

#include "kernels/shared/pack_texel.h"

namespace relume {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<unsigned char, 12> kIdentifier = {0xab, 'K',  'T',  'X',  ' ',  '2',
                                                       '0',  0xbb, '\r', '\n', 0x1a, '\n'};
constexpr std::uint32_t kHeaderBytes = 80;      ///< identifier, header and index
constexpr std::uint32_t kLevelIndexBytes = 24;  ///< of one level

/// Qualifiers of a sample of the data format descriptor, beside its channel.
constexpr std::uint32_t kExponent = 0x20, kSigned = 0x40, kFloat = 0x80;
constexpr std::uint32_t kRed = 0, kGreen = 1, kBlue = 2, kAlpha = 15;

class ByteWriter {
 public:
  template <class Value>
  void put(const Value& value) {
    const auto bytes = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void put(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void put(const ByteWriter& other) { bytes_.insert(bytes_.end(), other.bytes_.begin(), other.bytes_.end()); }
  void pad(std::size_t alignment) { bytes_.resize((bytes_.size() + alignment - 1) / alignment * alignment); }
  std::uint32_t size() const { return static_cast<std::uint32_t>(bytes_.size()); }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// A run of bits of a texel that belongs to a channel.
struct Sample {
  std::uint32_t offset, bits, channel;
  std::uint32_t lower,
      upper;  ///< what counts as 0 (or -1) and 1, as the channel stores it, floats as 32 bits
};

struct Description {
  std::uint32_t vulkan_format;
  std::uint32_t type_bytes;
  std::uint32_t texel_bytes;
  std::vector<Sample> samples;
};

constexpr std::uint32_t kMinusOne = std::bit_cast<std::uint32_t>(-1.0f),
                        kOne = std::bit_cast<std::uint32_t>(1.0f);

Sample half(std::uint32_t offset, std::uint32_t channel) {
  return {offset, 16, channel | kFloat | kSigned, kMinusOne, kOne};
}

Sample small_float(std::uint32_t offset, std::uint32_t bits, std::uint32_t channel) {
  return {offset, bits, channel | kFloat, 0, kOne};
}

/// Each channel is a mantissa and the exponent that all share; the limits are those of the specification's
/// example.
std::vector<Sample> shared_exponent_samples() {
  std::vector<Sample> samples;
  for (const std::uint32_t channel : {kRed, kGreen, kBlue}) {
    samples.push_back({9 * channel, 9, channel, 0, 8448});
    samples.push_back({27, 5, channel | kExponent, 15, 31});
  }
  return samples;
}

Description description_of(LightmapFormat format) {
  switch (format) {
    case LightmapFormat::r11g11b10f:
      return {VK_FORMAT_B10G11R11_UFLOAT_PACK32,
              4,
              4,
              {small_float(0, 11, kRed), small_float(11, 11, kGreen), small_float(22, 10, kBlue)}};
    case LightmapFormat::rgb9e5:
      return {VK_FORMAT_E5B9G9R9_UFLOAT_PACK32, 4, 4, shared_exponent_samples()};
    case LightmapFormat::rgba16f:
    case LightmapFormat::direction_rgba16f:
      break;
  }
  return {VK_FORMAT_R16G16B16A16_SFLOAT,
          2,
          8,
          {half(0, kRed), half(16, kGreen), half(32, kBlue), half(48, kAlpha)}};
}

/// One basic descriptor block: RGBSDA, BT.709 primaries, linear, straight alpha, blocks of one texel.
ByteWriter data_format_descriptor(const Description& description) {
  const auto block_bytes = static_cast<std::uint32_t>(24 + 16 * description.samples.size());
  ByteWriter out;
  out.put(4 + block_bytes);
  out.put(std::uint32_t{0});
  out.put(std::uint32_t{2} | (block_bytes << 16));  // version 1.3
  out.put(std::uint32_t{0x00010101});
  out.put(std::uint32_t{0});
  out.put(description.texel_bytes);
  out.put(std::uint32_t{0});
  for (const Sample& sample : description.samples) {
    out.put(sample.offset | ((sample.bits - 1) << 16) | (sample.channel << 24));
    out.put(std::uint32_t{0});
    out.put(sample.lower);
    out.put(sample.upper);
  }
  return out;
}

/// Keys ascend.
ByteWriter key_value_data() {
  constexpr std::string_view kZero("\0", 1);
  ByteWriter out;
  for (const std::array<std::string_view, 2>& pair :
       {std::array<std::string_view, 2>{"KTXorientation", "rd"}, {"KTXwriter", "relume " RELUME_VERSION}}) {
    out.put(static_cast<std::uint32_t>(pair[0].size() + pair[1].size() + 2));
    for (const std::string_view text : pair) {
      out.put(text);
      out.put(kZero);
    }
    out.pad(4);
  }
  return out;
}

ByteWriter texels_of(const ColorImage& image, LightmapFormat format) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  ByteWriter out;
  for (const glm::vec3& pixel : image.pixels) {
    const std::uint32_t red = bits(pixel.r), green = bits(pixel.g), blue = bits(pixel.b);
    if (format == LightmapFormat::r11g11b10f) out.put(kernels::pack_r11g11b10f(red, green, blue));
    if (format == LightmapFormat::rgb9e5) out.put(kernels::pack_rgb9e5(red, green, blue));
    if (format == LightmapFormat::rgba16f) {
      out.put(kernels::pack_half(red) | (kernels::pack_half(green) << 16));
      out.put(kernels::pack_half(blue) | (kernels::kHalfOne << 16));
    }
    if (format == LightmapFormat::direction_rgba16f) {
      out.put(kernels::pack_signed_half(red) | (kernels::pack_signed_half(green) << 16));
      out.put(kernels::pack_signed_half(blue) | (kernels::kHalfOne << 16));
    }
  }
  return out;
}

}  // namespace

std::vector<std::byte> encode_ktx2(const ColorImage& image, LightmapFormat format) {
  const Description description = description_of(format);
  const ByteWriter descriptor = data_format_descriptor(description);
  const ByteWriter pairs = key_value_data();
  const ByteWriter texels = texels_of(image, format);
  const std::uint32_t descriptor_offset = kHeaderBytes + kLevelIndexBytes;
  const std::uint32_t pairs_offset = descriptor_offset + descriptor.size();
  const std::uint64_t end = pairs_offset + pairs.size();
  const std::uint64_t level_offset =
      (end + description.texel_bytes - 1) / description.texel_bytes * description.texel_bytes;

  ByteWriter file;
  file.put(kIdentifier);
  // Format; size of a type; width, height, depth; layers, faces, levels; compression.
  for (const std::uint32_t word :
       {description.vulkan_format, description.type_bytes, image.width, image.height, 0u, 0u, 1u, 1u, 0u})
    file.put(word);
  for (const std::uint32_t word : {descriptor_offset, descriptor.size(), pairs_offset, pairs.size()})
    file.put(word);
  for (int i = 0; i < 2; ++i) file.put(std::uint64_t{0});  // no global data of a compression
  for (const std::uint64_t number :
       {level_offset, std::uint64_t{texels.size()}, std::uint64_t{texels.size()}})
    file.put(number);
  file.put(descriptor);
  file.put(pairs);
  file.pad(description.texel_bytes);
  file.put(texels);
  return file.take();
}

}  // namespace relume
