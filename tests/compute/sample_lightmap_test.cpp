// SPDX-License-Identifier: MIT
//
// From the pass to a renderer's shader: through the host's own view, the format's own decoder and the
// include.
#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <array>
#include <cmath>

#include "compute/lightmap_fixture.h"
#include "compute/run_kernel.h"
#include "compute/vulkan_info.h"
#include "spirv/sample_lightmap_probe.h"

namespace relume::test {
namespace {

class SampleLightmap : public LightmapTest, public testing::WithParamInterface<LightmapFormat> {
 protected:
  /// Radiance at each place (x, y in texels, albedo).
  std::vector<Rgb> seen(HostImage& image, VkFormat format, const std::vector<kernels::vec4>& places) {
    const BufferRange asked = allocate("places", 16 * places.size());
    const BufferRange answers = allocate("radiance", 16 * places.size());
    upload(asked, places);
    const VkDevice owner = device().host().device;
    auto info = vulkan_info<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
    info.magFilter = info.minFilter = VK_FILTER_LINEAR;
    info.addressModeU = info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    VkSampler sampler = VK_NULL_HANDLE;
    EXPECT_EQ(vkCreateSampler(owner, &info, nullptr, &sampler), VK_SUCCESS);
    const VulkanHandle<VkSampler> sampler_owner(owner, sampler, vkDestroySampler, nullptr);
    run_kernel(
        device(),
        {sample_lightmap_probe_spirv,
         {asked, answers},
         static_cast<std::uint32_t>(places.size()),
         VkDescriptorImageInfo{sampler, image.view(format, VK_IMAGE_USAGE_SAMPLED_BIT), kImageSampled.layout},
         [&](VkCommandBuffer commands) { image.record_transition(commands, kImageWritten, kImageSampled); }});
    return read_rgb(answers);
  }
};

VkFormat image_format(LightmapFormat format) {
  if (format == LightmapFormat::rgba16f) return VK_FORMAT_R16G16B16A16_SFLOAT;
  return format == LightmapFormat::rgb9e5 ? VK_FORMAT_E5B9G9R9_UFLOAT_PACK32
                                          : VK_FORMAT_B10G11R11_UFLOAT_PACK32;
}

// Lumels of 100 and 304 lux (red), side by side; every format holds these numbers. A white wall under 100 lux
// has 100 / pi = 31.831 cd/m2, one of albedo 0.5 half of it; half-way between the two lumels it is 202 lux.
TEST_P(SampleLightmap, GivesTheRadianceOfADiffuseSurface) {
  auto image = written(lumels_in_rows(2, 2), GetParam(), {{100.0f, 1.0f, 0.25f}, {304.0f, 1.0f, 0.0f}});
  ASSERT_TRUE(image);
  const std::vector<Rgb> radiance = seen(*image, image_format(GetParam()),
                                         {{0.5f, 0.5f, 1.0f, 0.0f},
                                          {0.5f, 0.5f, 0.5f, 0.0f},
                                          {1.5f, 0.5f, 1.0f, 0.0f},
                                          {1.0f, 0.5f, 1.0f, 0.0f},
                                          {0.5f, 0.5f, 1.0f, float(kPi / 3.0)},
                                          {0.5f, 0.5f, 1.0f, float(-kPi / 6.0)},
                                          {0.5f, 0.5f, 1.0f, float(-kPi / 2.0)}});
  EXPECT_NEAR(radiance[0].x, 31.830989, 1e-4);
  EXPECT_NEAR(radiance[1].x, 15.915494, 1e-4);
  EXPECT_NEAR(radiance[2].x, 96.766206, 1e-3);
  EXPECT_NEAR(radiance[3].x, 64.298597, 64.3 / 256);  // devices filter with 8 bits of weight
  EXPECT_NEAR(radiance[0].y, 0.31830989, 1e-6);
  // Under an even hemisphere a normal that leans by 60 degrees has (1 + 1/2) / 2 of it; in light from (0.6,
  // 0.8, 0) one that leans away by 30 degrees (0.8 cos 30 - 0.6 sin 30) / 0.8, and by 90 degrees nothing.
  EXPECT_NEAR(radiance[4].x, 0.75 * 31.830989, 1e-4);
  EXPECT_NEAR(radiance[5].x, (std::sqrt(0.75) - 0.375) * 31.830989, 1e-4);
  EXPECT_NEAR(radiance[6].x, 0.0, 1e-4);
  EXPECT_NEAR(radiance[0].z, 0.07957747, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Formats, SampleLightmap,
                         testing::Values(LightmapFormat::rgba16f, LightmapFormat::r11g11b10f,
                                         LightmapFormat::rgb9e5));

}  // namespace
}  // namespace relume::test
