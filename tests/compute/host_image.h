// SPDX-License-Identifier: MIT
//
// Images of a host, for passes that write or read them.
#pragma once

#include <vulkan/vulkan.h>

#include <span>
#include <vector>

#include "compute/lightmap_pass.h"
#include "compute/standalone/standalone_device.h"
#include "compute/standalone/standalone_memory.h"

namespace relume::test {

/// A stage and what it does, with the layout that the image has meanwhile.
struct ImageUse {
  VkImageLayout layout;
  VkPipelineStageFlags stage;
  VkAccessFlags access;
};

inline constexpr ImageUse kUndefined{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, 0};
inline constexpr ImageUse kImageCopyTarget{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                           VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT};
inline constexpr ImageUse kImageCopySource{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                           VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT};
inline constexpr ImageUse kImageWritten{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                        VK_ACCESS_SHADER_WRITE_BIT};
inline constexpr ImageUse kImageSampled{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                        VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT};

struct ImageShape {
  VkFormat format;
  VkExtent2D extent;
  VkImageUsageFlags usage;
  VkImageCreateFlags flags = 0;
};

/// An image with memory of its own.
class HostImage {
 public:
  HostImage(const StandaloneDevice& device, const ImageShape& shape);

  /// Null when something failed.
  VkImage image() const { return image_.get(); }

  /// A view of the whole image; it lives as long as the image.
  VkImageView view(VkFormat format, VkImageUsageFlags usage);

  void record_transition(VkCommandBuffer commands, const ImageUse& from, const ImageUse& to) const;

  /// Fills it with `texels`, tightly packed, and leaves it as `use` says.
  void upload(StandaloneDevice& device, std::span<const std::byte> texels, const ImageUse& use);

  /// The texels, tightly packed, of an image that was last in use as `use` says.
  std::vector<std::byte> download(StandaloneDevice& device, const ImageUse& use, VkDeviceSize texel_bytes);

 private:
  VkBufferImageCopy whole() const;

  VkDevice device_;
  VkExtent2D extent_;
  VulkanHandle<VkDeviceMemory> memory_;
  VulkanHandle<VkImage> image_;
  std::vector<VulkanHandle<VkImageView>> views_;
};

/// The image that a lightmap pass asks for, with copies allowed; cleared to zero, in layout GENERAL.
HostImage make_lightmap_image(StandaloneDevice& device, const LightmapImage& needed);

}  // namespace relume::test
