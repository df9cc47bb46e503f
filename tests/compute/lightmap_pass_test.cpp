// SPDX-License-Identifier: MIT
#include "compute/lightmap_pass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <cstring>
#include <limits>
#include <ostream>

#include "compute/lightmap_fixture.h"
#include "compute/test_models.h"
#include "compute/texel_formats.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

class LightmapPassTest : public LightmapTest {
 protected:
  /// What the image holds after one pass over these values.
  std::vector<Rgb> shown(const System& system, LightmapFormat format,
                         const std::vector<glm::vec3>& irradiance,
                         const std::vector<glm::vec3>& direct = {}) {
    std::optional<HostImage> image = written(system, format, irradiance, direct);
    return image ? decoded(*image, format) : std::vector<Rgb>{};
  }

 private:
  std::vector<Rgb> decoded(HostImage& image, LightmapFormat format) {
    const bool wide = format == LightmapFormat::rgba16f || format == LightmapFormat::direction_rgba16f;
    const std::vector<std::byte> bytes = image.download(device(), kImageWritten, wide ? 8 : 4);
    std::vector<Rgb> colors;
    for (std::size_t at = 0; at < bytes.size(); at += wide ? 8 : 4) {
      std::array<std::uint16_t, 4> halves{};
      std::uint32_t word = 0;
      std::memcpy(&halves, &bytes[at], wide ? 8 : 4);
      std::memcpy(&word, &bytes[at], 4);
      if (wide) colors.push_back(decode_rgba16f(halves));
      if (format == LightmapFormat::r11g11b10f) colors.push_back(decode_r11g11b10f(word));
      if (format == LightmapFormat::rgb9e5) colors.push_back(decode_rgb9e5(word));
    }
    return colors;
  }
};

struct FormatCase {
  const char* name;
  LightmapFormat format;
  double max_bias;
  Rgb max_error;  ///< relative, of the brightest channel for the shared exponent
};

void PrintTo(const FormatCase& format, std::ostream* out) {
  *out << format.name;
}

class LightmapFormats : public LightmapPassTest, public testing::WithParamInterface<FormatCase> {};

// Rounding to nearest has no bias: 3000 relative errors of up to 2^-11 (16F), each as likely up as down.
TEST_P(LightmapFormats, HaveNoBias) {
  Random random(11);
  std::vector<glm::vec3> values;
  for (int i = 0; i < 1000; ++i) {
    const double scale = std::exp2(14.0 * random.unit());
    const auto channel = [&] { return static_cast<float>(scale * (0.5 + 0.5 * random.unit())); };
    const float r = channel(), g = channel(), b = channel();
    values.emplace_back(r, g, b);
  }
  const std::vector<Rgb> texels = shown(lumels_in_rows(values.size(), 40), GetParam().format, values);
  ASSERT_EQ(texels.size(), values.size());
  Rgb bias(0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Rgb error = (texels[i] - Rgb(values[i])) / Rgb(values[i]);
    bias += error / double(values.size());
    for (int c = 0; c < 3; ++c) ASSERT_LE(std::abs(error[c]), GetParam().max_error[c]) << i;
  }
  EXPECT_LT(std::abs(bias.x + bias.y + bias.z) / 3.0, GetParam().max_bias);
}

// The kernels do what the packing does that pack_texel_test checks: denormals, ties, overflow, NaN.
TEST_P(LightmapFormats, KeepCornerValues) {
  const float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<glm::vec3> values{
      {1.0f, 0.5f, 0.25f},       {0.0f, 0.0f, 0.0f}, {0x1p-19f, 0x1p-19f, 0x1p-19f},
      {infinity, 1e9f, 65536.f}, {nan, -1.0f, 2.0f}, {-infinity, 0.0f, nan}};
  const std::vector<Rgb> texels = shown(lumels_in_rows(values.size(), 6), GetParam().format, values);
  ASSERT_EQ(texels.size(), values.size());
  EXPECT_EQ(texels[0], Rgb(1.0, 0.5, 0.25));
  EXPECT_EQ(texels[1], Rgb(0.0));
  EXPECT_EQ(texels[2],
            Rgb(0x1p-19));  // 32, 2 and 1 of the smallest of 16F, 11 bits and 10; 32 of 2^-24 in rgb9e5
  const bool shared = GetParam().format == LightmapFormat::rgb9e5;
  const bool wide = GetParam().format == LightmapFormat::rgba16f;
  EXPECT_EQ(texels[3], shared ? Rgb(65408.0) : wide ? Rgb(65504.0) : Rgb(65024.0, 65024.0, 64512.0));
  EXPECT_EQ(texels[4], Rgb(0.0, 0.0, 2.0));
  EXPECT_EQ(texels[5], Rgb(0.0));
}

INSTANTIATE_TEST_SUITE_P(
    Formats, LightmapFormats,
    testing::Values(FormatCase{"rgba16f", LightmapFormat::rgba16f, 1e-5, Rgb(0x1p-11)},
                    FormatCase{"r11g11b10f", LightmapFormat::r11g11b10f, 1e-3, Rgb(0x1p-7, 0x1p-7, 0x1p-6)},
                    // half a unit of 2^-9 of up to twice the largest, which is up to twice a channel
                    FormatCase{"rgb9e5", LightmapFormat::rgb9e5, 1e-4, Rgb(0x1p-8)}),
    [](const auto& format) { return format.param.name; });

//     . . . .      A = 1, B = 4 (red); i: invalid, as near to A as to B; what is right of B is four texels
//     wide A i B . ...  so that the last stays as the host cleared it
TEST_F(LightmapPassTest, FillsAndDilates) {
  System system;
  system.name = "room";
  system.lightmap_width = 8;
  system.lightmap_height = 2;
  system.lumels = {{0, 1, 0, 0}, {1, 1, 0, kLumelInvalid}, {2, 1, 0, 0}};
  const std::vector<Rgb> texels =
      shown(system, LightmapFormat::rgba16f, {{1.0f, 0.0f, 0.0f}, {1000.0f, 0.0f, 0.0f}, {4.0f, 0.0f, 0.0f}});
  std::vector<double> red;
  for (const Rgb& texel : texels) red.push_back(texel.x);
  EXPECT_THAT(red, testing::ElementsAre(1.0, 2.5, 4.0, 4.0, 4.0, 4.0, 4.0, 0.0,  //
                                        1.0, 2.5, 4.0, 4.0, 4.0, 4.0, 4.0, 0.0));
}

// A: grey light of 2 lux from (0.5, -0.25, 0). B: blue light, from its own direction whatever the red one is,
// of which there is none. Between them the mean of both lights: 2 + 4 lux, moments of A and B together. The
// last is dark.
TEST_F(LightmapPassTest, ShowsWhereLightComesFrom) {
  System system;
  system.name = "room";
  system.lightmap_width = 4;
  system.lightmap_height = 1;
  system.lumels = {{0, 0, 0, 0}, {1, 0, 0, kLumelInvalid}, {2, 0, 0, 0}, {3, 0, 0, 0}};
  system.gather.blocks.resize(1);
  system.gather.blocks[0].directions = {0};
  const float blue = 4.0f / 0.0722f;
  const std::vector<glm::vec3> zero(3, glm::vec3(0.0f));
  std::vector<glm::vec3> rows{glm::vec3(2.0f), glm::vec3(9.0f), {0.0f, 0.0f, blue}, glm::vec3(0.0f)};
  const std::vector<glm::vec3> moments_of_a{glm::vec3(1.0f), glm::vec3(-0.5f), glm::vec3(0.0f)};
  const std::vector<glm::vec3> moments_of_b{glm::vec3(0.0f), {0.0f, 0.0f, blue}, {0.0f, 0.0f, -blue}};
  for (const auto& moments : {moments_of_a, zero, moments_of_b, zero})
    rows.insert(rows.end(), moments.begin(), moments.end());

  const std::vector<Rgb> d = shown(system, LightmapFormat::direction_rgba16f, rows);
  ASSERT_EQ(d.size(), 4u);
  const double unit = std::sqrt(0.5);  // B is longer than 1: |D| <= I holds for no real light there
  EXPECT_LT(glm::distance(d[0], Rgb(0.5, -0.25, 0.0)), 1e-3);
  EXPECT_LT(glm::distance(d[1], Rgb(1.0, 3.5, -4.0) / 6.0), 1e-3);
  EXPECT_LT(glm::distance(d[2], Rgb(0.0, unit, -unit)), 1e-3);
  EXPECT_EQ(d[3], Rgb(0.0));
}

TEST_F(LightmapPassTest, AddsDirectLight) {
  const std::vector<Rgb> texels =
      shown(lumels_in_rows(2, 2), LightmapFormat::rgb9e5, {{1.0f, 2.0f, 3.0f}, {0.0f, 0.0f, 8.0f}},
            {{4.0f, 0.0f, 1.0f}, {1.0f, 1.0f, 0.0f}});
  EXPECT_EQ(texels[0], Rgb(5.0, 2.0, 4.0));
  EXPECT_EQ(texels[1], Rgb(1.0, 1.0, 8.0));
}

// More texels than one dispatch has: 640 x 500 is above 2^18.
TEST_F(LightmapPassTest, CutsLargeLightmapsIntoDispatches) {
  System system;
  system.name = "hall";
  system.lightmap_width = 640;
  system.lightmap_height = 500;
  system.lumels = {{0, 0, 0, 0}};
  for (std::uint32_t i = 1; i < 640 * 500; ++i)
    system.lumels.push_back({std::uint16_t(i % 640), std::uint16_t(i / 640), 0, kLumelInvalid});
  std::vector<glm::vec3> values(system.lumels.size(), glm::vec3(0.0f));
  values[0] = {3.0f, 2.0f, 1.0f};
  const std::vector<Rgb> texels = shown(system, LightmapFormat::rgb9e5, values);
  EXPECT_EQ(texels.size(), 320000u);
  EXPECT_THAT(texels, testing::Each(Rgb(3.0, 2.0, 1.0)));
}

TEST_F(LightmapPassTest, RefusesWhatDoesNotFit) {
  const System system = lumels_in_rows(4, 2);
  const LightmapTexels texels = lightmap_texels(system);
  const auto none = LightmapPass::create(device().host(), System{}, {}, LightmapFormat::rgb9e5);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::usage);
  auto pass = LightmapPass::create(device().host(), system, texels, LightmapFormat::rgb9e5);
  ASSERT_TRUE(pass) << pass.error().message;
  const auto few = pass->bind({}, {}, VK_NULL_HANDLE);
  ASSERT_FALSE(few);
  EXPECT_THAT(few.error().message, HasSubstr("2 buffers, found 0"));
  const auto directions =
      LightmapPass::create(device().host(), system, texels, LightmapFormat::direction_rgba16f);
  ASSERT_FALSE(directions);
  EXPECT_THAT(directions.error().message, HasSubstr("precompute --directional"));
  const std::vector<BufferRange> ranges = allocate(pass->buffers());
  const BufferRange small = allocate("irradiance", 48);
  const auto short_input = pass->bind(ranges, {small, {}}, VK_NULL_HANDLE);
  ASSERT_FALSE(short_input);
  EXPECT_THAT(short_input.error().message, HasSubstr("'irradiance' needs 64 bytes"));
  const BufferRange enough = allocate("irradiance", 64 * 8);
  const auto no_image = pass->bind(ranges, {enough, {}}, VK_NULL_HANDLE);
  ASSERT_FALSE(no_image);
  EXPECT_THAT(no_image.error().message, HasSubstr("expected a view of the host's image"));
}

}  // namespace
}  // namespace relume::test
