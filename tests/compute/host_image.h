// SPDX-License-Identifier: MIT
//
// Images of a host, for passes that write or read them.
#pragma once

#include <vulkan/vulkan.h>

#include <span>
#include <vector>

#include "compute/lightmap_pass.h"
#include "compute/standalone/standalone_image.h"

namespace relume::test {

/// An image with memory of its own; a test fails where something of it does.
class HostImage {
 public:
  HostImage(const StandaloneDevice& device, const ImageShape& shape);
  HostImage(const StandaloneDevice& device, DeviceImage image) : device_(&device), image_(std::move(image)) {}

  /// Null when something failed.
  VkImage image() const { return image_.image.get(); }

  /// A view of the whole image; it lives as long as the image.
  VkImageView view(VkFormat format, VkImageUsageFlags usage);

  void record_transition(VkCommandBuffer commands, const ImageUse& from, const ImageUse& to) const {
    relume::record_transition(commands, image_, from, to);
  }

  /// As write_image and read_image.
  void upload(StandaloneDevice& device, std::span<const std::byte> texels, const ImageUse& use);
  std::vector<std::byte> download(StandaloneDevice& device, const ImageUse& use, VkDeviceSize texel_bytes);

 private:
  const StandaloneDevice* device_;
  DeviceImage image_;
  std::vector<VulkanHandle<VkImageView>> views_;
};

/// Texels as they are, repeated beyond the image.
VulkanHandle<VkSampler> nearest_sampler(const StandaloneDevice& device);

/// As relume::make_lightmap_target.
HostImage make_lightmap_image(StandaloneDevice& device, const LightmapImage& needed);

}  // namespace relume::test
