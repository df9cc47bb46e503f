// SPDX-License-Identifier: MIT
#include "compute/host_image.h"

#include <gtest/gtest.h>

#include "compute/vulkan_info.h"

namespace relume::test {
namespace {

DeviceImage made(Result<DeviceImage> image) {
  EXPECT_TRUE(image) << image.error().message;
  return image ? std::move(*image) : DeviceImage{};
}

}  // namespace

HostImage::HostImage(const StandaloneDevice& device, const ImageShape& shape)
    : device_(&device), image_(made(make_device_image(device, shape))) {}

VkImageView HostImage::view(VkFormat format, VkImageUsageFlags usage) {
  auto view = make_image_view(*device_, image_, format, usage);
  EXPECT_TRUE(view) << view.error().message;
  if (!view) return VK_NULL_HANDLE;
  views_.push_back(std::move(*view));
  return views_.back().get();
}

void HostImage::upload(StandaloneDevice& device, std::span<const std::byte> texels, const ImageUse& use) {
  const auto written = write_image(device, image_, texels, use);
  EXPECT_TRUE(written) << written.error().message;
}

std::vector<std::byte> HostImage::download(StandaloneDevice& device, const ImageUse& use,
                                           VkDeviceSize texel_bytes) {
  auto texels = read_image(device, image_, use, texel_bytes);
  EXPECT_TRUE(texels) << texels.error().message;
  return texels ? std::move(*texels) : std::vector<std::byte>{};
}

VulkanHandle<VkSampler> nearest_sampler(const StandaloneDevice& device) {
  const auto info = vulkan_info<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
  VkSampler sampler = VK_NULL_HANDLE;
  VkDevice owner = device.host().device;
  EXPECT_EQ(vkCreateSampler(owner, &info, nullptr, &sampler), VK_SUCCESS);
  return {owner, sampler, vkDestroySampler, nullptr};
}

HostImage make_lightmap_image(StandaloneDevice& device, const LightmapImage& needed) {
  return {device, made(relume::make_lightmap_target(device, needed))};
}

}  // namespace relume::test
