// SPDX-License-Identifier: MIT
#include "kernels/shared/pack_texel.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "compute/test_models.h"
#include "compute/texel_formats.h"

namespace relume::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::uint32_t bits(float value) {
  return std::bit_cast<std::uint32_t>(value);
}

std::uint32_t rgb9e5(float r, float g, float b) {
  return kernels::pack_rgb9e5(bits(r), bits(g), bits(b));
}

TEST(SignedHalf, HasASignAndElseTheBitsOfTheUnsigned) {
  const auto pack = [](float value) { return kernels::pack_signed_half(bits(value)); };
  EXPECT_EQ(pack(1.0f), 0x3c00u);
  EXPECT_EQ(pack(-1.0f), 0xbc00u);
  EXPECT_EQ(pack(-0.75f), 0xba00u);
  EXPECT_EQ(pack(-kInfinity), 0xfbffu);  // -65504
  EXPECT_EQ(pack(kNan), 0u);
}

class SmallFloat : public testing::TestWithParam<std::uint32_t> {
 protected:
  std::uint32_t mantissa_bits() const { return GetParam(); }
  std::uint32_t pack(float value) const { return kernels::pack_small_float(bits(value), mantissa_bits()); }
  float value_of(std::uint32_t code) const {
    return static_cast<float>(small_float(code, static_cast<int>(mantissa_bits())));
  }
  std::uint32_t largest() const { return (31u << mantissa_bits()) - 1u; }
};

TEST_P(SmallFloat, KeepsWhatItCanHold) {
  for (std::uint32_t code = 0; code <= largest(); ++code) ASSERT_EQ(pack(value_of(code)), code);
}

// The middle of two neighbours has one bit more and fits a 32-bit float.
TEST_P(SmallFloat, RoundsToNearestAndTiesToEven) {
  for (std::uint32_t code = 0; code < largest(); ++code) {
    const float middle = 0.5f * (value_of(code) + value_of(code + 1));
    ASSERT_EQ(pack(middle), code + (code & 1u)) << code;
    ASSERT_EQ(pack(std::nextafter(middle, 0.0f)), code) << code;
    ASSERT_EQ(pack(std::nextafter(middle, kInfinity)), code + 1) << code;
  }
}

TEST_P(SmallFloat, ClampsAndNeverGivesInfinityOrNan) {
  EXPECT_EQ(pack(std::nextafter(value_of(largest()), kInfinity)), largest());
  EXPECT_EQ(pack(1e30f), largest());
  EXPECT_EQ(pack(kInfinity), largest());
  EXPECT_EQ(pack(kNan), 0u);
  EXPECT_EQ(pack(-kNan), 0u);
  EXPECT_EQ(pack(-1.0f), 0u);
  EXPECT_EQ(pack(-kInfinity), 0u);
  EXPECT_EQ(pack(-0.0f), 0u);
  EXPECT_EQ(pack(std::numeric_limits<float>::denorm_min()), 0u);
  EXPECT_EQ(pack(std::numeric_limits<float>::min()), 0u);
}

INSTANTIATE_TEST_SUITE_P(MantissaBits, SmallFloat, testing::Values(10u, 6u, 5u));

TEST(PackTexel, HalvesByHand) {
  EXPECT_EQ(kernels::pack_half(bits(1.0f)), 0x3c00u);
  EXPECT_EQ(kernels::pack_half(bits(65504.0f)), 0x7bffu);
  EXPECT_EQ(kernels::pack_half(bits(0x1p-24f)), 0x0001u);         // the smallest
  EXPECT_EQ(kernels::pack_half(bits(0x1p-25f)), 0x0000u);         // half of it: the tie goes to 0
  EXPECT_EQ(kernels::pack_half(bits(0x1.8p-24f)), 0x0002u);       // 1.5 of it: to the even 2
  EXPECT_EQ(kernels::pack_half(bits(0x1.ffcp-15f)), 0x0400u);     // between the largest denormal and 2^-14
  EXPECT_EQ(kernels::pack_half(bits(1.0f + 0x1p-11f)), 0x3c00u);  // the tie goes to the even 1
  EXPECT_EQ(kernels::pack_half(bits(1.0f + 3 * 0x1p-11f)), 0x3c02u);
}

// 1: exponent 15, mantissa 0. Red of 11 bits, green of 11, blue of 10.
TEST(PackTexel, R11G11B10ByHand) {
  EXPECT_EQ(kernels::pack_r11g11b10f(bits(1.0f), 0u, 0u), 15u << 6);
  EXPECT_EQ(kernels::pack_r11g11b10f(0u, bits(1.5f), 0u), ((15u << 6) | 32u) << 11);
  EXPECT_EQ(kernels::pack_r11g11b10f(0u, 0u, bits(0.75f)), ((14u << 5) | 16u) << 22);
  EXPECT_EQ(kernels::pack_r11g11b10f(bits(kInfinity), bits(65024.0f), bits(64512.0f)),
            0x7bfu | (0x7bfu << 11) | (0x3dfu << 22));
  EXPECT_EQ(kernels::pack_r11g11b10f(bits(0x1p-20f), bits(0x1p-20f), bits(0x1p-19f)),
            1u | (1u << 11) | (1u << 22));
}

TEST(PackTexel, Rgb9e5ByHand) {
  EXPECT_EQ(rgb9e5(0.0f, 0.0f, 0.0f), 0u);
  EXPECT_EQ(rgb9e5(1.0f, 0.5f, 0.25f), 256u | (128u << 9) | (64u << 18) | (16u << 27));
  EXPECT_EQ(rgb9e5(65408.0f, 0.0f, 0.0f), 511u | (31u << 27));
  EXPECT_EQ(rgb9e5(1e9f, kInfinity, kNan), 511u | (511u << 9) | (31u << 27));
  EXPECT_EQ(rgb9e5(-3.0f, 2.0f, -kInfinity), (256u << 9) | (17u << 27));
  EXPECT_EQ(rgb9e5(0x1p-24f, 0x1p-25f, 0x1.8p-24f), 1u | (0u << 9) | (2u << 18));  // exponent 0; ties to even
  EXPECT_EQ(rgb9e5(511.5f / 512, 0.0f, 0.0f), 256u | (16u << 27));  // rounds up to 512: the next exponent
  EXPECT_EQ(rgb9e5(1.0f, 0x1p-9f, 0x1.8p-8f), 256u | (0u << 9) | (2u << 18) | (16u << 27));  // units of 2^-8
}

// The exponent is the least that holds the largest channel, and each channel is the nearest multiple of its
// unit.
TEST(PackTexel, Rgb9e5IsTheNearestOfTheLeastExponent) {
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(random.below(44)) - 27);
    const auto channel = [&] { return static_cast<float>(std::min(65408.0, scale * random.unit())); };
    const glm::vec3 color(channel(), channel(), channel());
    const std::uint32_t word = rgb9e5(color.x, color.y, color.z);
    const auto exponent = static_cast<int>(word >> 27);
    const Rgb error = decode_rgb9e5(word) - Rgb(color);
    const double half_unit = std::ldexp(0.5, exponent - 24);
    for (int c = 0; c < 3; ++c) ASSERT_LE(std::abs(error[c]), half_unit) << i;
    const double largest = std::max({color.x, color.y, color.z});
    const double least = exponent > 0 ? (511.5 / 512) * std::ldexp(1.0, exponent - 16) : 0.0;
    ASSERT_GE(largest, least) << i;
  }
}

}  // namespace
}  // namespace relume::test
