// SPDX-License-Identifier: MIT
//
// A reader of KTX 2.0, written from the specification, that refuses whatever breaks it.
#include "tool/ktx2.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <map>
#include <numeric>
#include <string>

#include "compute/texel_formats.h"

namespace relume::test {
namespace {

struct Channel {
  std::uint32_t offset, bits, id, qualifiers, lower, upper;
};

struct Ktx2 {
  std::uint32_t format = 0, type_size = 0, width = 0, height = 0;
  std::uint32_t primaries = 0, transfer = 0, model = 0;
  std::vector<Channel> channels;
  std::map<std::string, std::string> pairs;
  std::vector<std::byte> level;
};

template <class T>
T value_at(const std::vector<std::byte>& bytes, std::size_t at) {
  T value{};
  if (at + sizeof value > bytes.size()) {
    ADD_FAILURE() << "byte " << at << " is past the end";
    return value;
  }
  std::memcpy(&value, &bytes[at], sizeof value);
  return value;
}

/// Section 5 of the Data Format Specification 1.3: the basic descriptor block.
void read_descriptor(const std::vector<std::byte>& bytes, std::size_t at, std::size_t length, Ktx2& file) {
  const auto word = [&](std::size_t i) { return value_at<std::uint32_t>(bytes, at + 4 * i); };
  EXPECT_EQ(word(0), length);  // dfdTotalSize
  EXPECT_EQ(word(1), 0u);      // vendor Khronos, basic format
  EXPECT_EQ(word(2) & 0xffffu, 2u);
  const std::size_t block = word(2) >> 16;
  EXPECT_EQ(block, length - 4);
  file.model = word(3) & 0xffu;
  file.primaries = (word(3) >> 8) & 0xffu;
  file.transfer = (word(3) >> 16) & 0xffu;
  EXPECT_EQ(word(3) >> 24, 0u);
  EXPECT_EQ(word(4), 0u);  // one texel is a block
  EXPECT_EQ(word(6), 0u);
  for (std::size_t i = 7; 4 * (i + 4) <= length; i += 4) {
    EXPECT_EQ(word(i + 1), 0u);
    file.channels.push_back({word(i) & 0xffffu, ((word(i) >> 16) & 0xffu) + 1, (word(i) >> 24) & 0xfu,
                             (word(i) >> 24) & 0xf0u, word(i + 2), word(i + 3)});
  }
  EXPECT_EQ(24 + 16 * file.channels.size(), block);
}

/// Section 3.11: pairs in the order of their keys, each padded to 4 bytes.
void read_pairs(const std::vector<std::byte>& bytes, std::size_t at, std::size_t length, Ktx2& file) {
  std::string last;
  for (const std::size_t end = at + length; at < end;) {
    const auto size = value_at<std::uint32_t>(bytes, at);
    std::string text(size, '\0');
    ASSERT_LE(at + 4 + size, end);
    std::memcpy(text.data(), &bytes[at + 4], size);
    const std::string key = text.substr(0, text.find('\0'));
    EXPECT_LT(last, key);
    EXPECT_EQ(text.back(), '\0');
    file.pairs[key] = text.substr(key.size() + 1, size - key.size() - 2);
    last = key;
    at += 4 + (size + 3) / 4 * 4;
  }
}

Ktx2 read(const std::vector<std::byte>& bytes) {
  Ktx2 file;
  const std::array<unsigned char, 12> identifier = {0xab, 0x4b, 0x54, 0x58, 0x20, 0x32,
                                                    0x30, 0xbb, 0x0d, 0x0a, 0x1a, 0x0a};
  EXPECT_EQ(std::memcmp(bytes.data(), identifier.data(), 12), 0);
  const auto word = [&](std::size_t at) { return value_at<std::uint32_t>(bytes, at); };
  const auto wide = [&](std::size_t at) { return value_at<std::uint64_t>(bytes, at); };
  file.format = word(12);
  file.type_size = word(16);
  file.width = word(20);
  file.height = word(24);
  EXPECT_EQ(word(28), 0u);  // depth: 2D
  EXPECT_EQ(word(32), 0u);  // layers: no array
  EXPECT_EQ(word(36), 1u);  // faces
  EXPECT_EQ(word(40), 1u);  // levels
  EXPECT_EQ(word(44), 0u);  // supercompression
  const std::size_t descriptor = word(48), descriptor_bytes = word(52), pairs = word(56),
                    pairs_bytes = word(60);
  EXPECT_EQ(wide(64), 0u);
  EXPECT_EQ(wide(72), 0u);
  EXPECT_EQ(descriptor, 80u + 24u);
  EXPECT_EQ(pairs, descriptor + descriptor_bytes);
  read_descriptor(bytes, descriptor, descriptor_bytes, file);
  read_pairs(bytes, pairs, pairs_bytes, file);
  const std::size_t level = wide(80), level_bytes = wide(88);
  EXPECT_EQ(wide(96), level_bytes);
  const std::uint32_t texel_bytes = value_at<std::uint32_t>(bytes, descriptor + 4 + 16);  // bytesPlane0
  EXPECT_EQ(level % std::lcm(texel_bytes, 4u), 0u);
  EXPECT_EQ(level_bytes, std::size_t{texel_bytes} * file.width * file.height);
  EXPECT_GE(level, pairs + pairs_bytes);
  EXPECT_EQ(level + level_bytes, bytes.size());
  if (level + level_bytes == bytes.size())
    file.level.assign(bytes.begin() + std::ptrdiff_t(level), bytes.end());
  EXPECT_EQ(file.model, 1u);      // KHR_DF_MODEL_RGBSDA
  EXPECT_EQ(file.primaries, 1u);  // KHR_DF_PRIMARIES_BT709
  EXPECT_EQ(file.transfer, 1u);   // KHR_DF_TRANSFER_LINEAR
  EXPECT_EQ(file.pairs["KTXorientation"], "rd");
  EXPECT_EQ(file.pairs["KTXwriter"].substr(0, 7), "relume ");
  return file;
}

/// 3 x 2 texels whose numbers all formats hold.
ColorImage sketch() {
  ColorImage image(3, 2);
  image.at(0, 0) = {1.0f, 0.5f, 0.25f};
  image.at(2, 0) = {96.0f, 1.0f, 2.0f};
  image.at(1, 1) = {0.0f, 1024.0f, 64.0f};
  return image;
}

constexpr std::uint32_t kFloatBit = 0x80, kSignedBit = 0x40, kExponentBit = 0x20;

TEST(Ktx2, HalvesAreWhatTheSpecificationSays) {
  const Ktx2 file = read(encode_ktx2(sketch(), LightmapFormat::rgba16f));
  EXPECT_EQ(file.format, 97u);  // VK_FORMAT_R16G16B16A16_SFLOAT
  EXPECT_EQ(file.type_size, 2u);
  ASSERT_EQ(file.channels.size(), 4u);
  const std::array<std::uint32_t, 4> ids = {0, 1, 2, 15};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Channel& channel = file.channels[i];
    EXPECT_EQ(channel.offset, 16 * i);
    EXPECT_EQ(channel.bits, 16u);
    EXPECT_EQ(channel.id, ids[i]);
    EXPECT_EQ(channel.qualifiers, kFloatBit | kSignedBit);
    EXPECT_EQ(channel.lower, std::bit_cast<std::uint32_t>(-1.0f));
    EXPECT_EQ(channel.upper, std::bit_cast<std::uint32_t>(1.0f));
  }
  ASSERT_EQ(file.level.size(), 48u);
  EXPECT_EQ(decode_rgba16f(value_at<std::array<std::uint16_t, 4>>(file.level, 16)), Rgb(96.0, 1.0, 2.0));
  EXPECT_EQ(decode_rgba16f(value_at<std::array<std::uint16_t, 4>>(file.level, 32)), Rgb(0.0, 1024.0, 64.0));
  EXPECT_EQ(value_at<std::uint16_t>(file.level, 6), 0x3c00u);  // alpha 1
}

TEST(Ktx2, DirectionsKeepTheirSigns) {
  ColorImage image(1, 1);
  image.at(0, 0) = {-0.75f, 0.5f, -1.0f};
  const Ktx2 file = read(encode_ktx2(image, LightmapFormat::direction_rgba16f));
  EXPECT_EQ(file.format, 97u);
  ASSERT_EQ(file.level.size(), 8u);
  EXPECT_EQ((value_at<std::array<std::uint16_t, 4>>(file.level, 0)),
            (std::array<std::uint16_t, 4>{0xba00, 0x3800, 0xbc00, 0x3c00}));
}

TEST(Ktx2, SmallFloatsAreWhatTheSpecificationSays) {
  const Ktx2 file = read(encode_ktx2(sketch(), LightmapFormat::r11g11b10f));
  EXPECT_EQ(file.format, 122u);  // VK_FORMAT_B10G11R11_UFLOAT_PACK32
  EXPECT_EQ(file.type_size, 4u);
  ASSERT_EQ(file.channels.size(), 3u);
  const std::array<std::uint32_t, 3> bits = {11, 11, 10};
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(file.channels[i].offset, 11 * i);
    EXPECT_EQ(file.channels[i].bits, bits[i]);
    EXPECT_EQ(file.channels[i].id, i);
    EXPECT_EQ(file.channels[i].qualifiers, kFloatBit);
    EXPECT_EQ(file.channels[i].upper, std::bit_cast<std::uint32_t>(1.0f));
  }
  ASSERT_EQ(file.level.size(), 24u);
  EXPECT_EQ(decode_r11g11b10f(value_at<std::uint32_t>(file.level, 0)), Rgb(1.0, 0.5, 0.25));
  EXPECT_EQ(decode_r11g11b10f(value_at<std::uint32_t>(file.level, 16)), Rgb(0.0, 1024.0, 64.0));
}

// Example of section 15.4 of the Data Format Specification 1.3.
TEST(Ktx2, SharedExponentsAreWhatTheSpecificationSays) {
  const Ktx2 file = read(encode_ktx2(sketch(), LightmapFormat::rgb9e5));
  EXPECT_EQ(file.format, 123u);  // VK_FORMAT_E5B9G9R9_UFLOAT_PACK32
  EXPECT_EQ(file.type_size, 4u);
  ASSERT_EQ(file.channels.size(), 6u);
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Channel& mantissa = file.channels[2 * i];
    const Channel& exponent = file.channels[2 * i + 1];
    EXPECT_EQ(mantissa.offset, 9 * i);
    EXPECT_EQ(mantissa.bits, 9u);
    EXPECT_EQ(mantissa.qualifiers, 0u);
    EXPECT_EQ(mantissa.upper, 8448u);
    EXPECT_EQ(exponent.offset, 27u);
    EXPECT_EQ(exponent.bits, 5u);
    EXPECT_EQ(exponent.qualifiers, kExponentBit);
    EXPECT_EQ(exponent.lower, 15u);
    EXPECT_EQ(exponent.upper, 31u);
    EXPECT_EQ(mantissa.id, i);
    EXPECT_EQ(exponent.id, i);
  }
  ASSERT_EQ(file.level.size(), 24u);
  EXPECT_EQ(decode_rgb9e5(value_at<std::uint32_t>(file.level, 8)), Rgb(96.0, 1.0, 2.0));
  EXPECT_EQ(decode_rgb9e5(value_at<std::uint32_t>(file.level, 20)), Rgb(0.0));
}

}  // namespace
}  // namespace relume::test
