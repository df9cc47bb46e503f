// SPDX-License-Identifier: MIT
//
// Images of a StandaloneDevice: 2D, one level, one layer.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <span>
#include <vector>

#include "compute/lightmap_pass.h"
#include "compute/standalone/standalone_device.h"
#include "compute/vulkan_handle.h"
#include "core/result.h"

namespace relume {

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

/// An image with memory of its own. The device must outlive it.
struct DeviceImage {
  VulkanHandle<VkDeviceMemory> memory;
  VulkanHandle<VkImage> image;
  VkExtent2D extent{};
};

/// In device memory. Fails with out_of_memory.
Result<DeviceImage> make_device_image(const StandaloneDevice& device, const ImageShape& shape);

/// A view of the whole image for `usage` alone.
Result<VulkanHandle<VkImageView>> make_image_view(const StandaloneDevice& device, const DeviceImage& image,
                                                  VkFormat format, VkImageUsageFlags usage);

/// What `from` did is done before `to` starts, and the image changes its layout.
void record_transition(VkCommandBuffer commands, const DeviceImage& image, const ImageUse& from,
                       const ImageUse& to);

/// Fills the image (usage TRANSFER_DST) with `texels`, tightly packed, and leaves it as `use` says.
Result<void> write_image(StandaloneDevice& device, const DeviceImage& image,
                         std::span<const std::byte> texels, const ImageUse& use);

/// The texels, tightly packed, of an image (usage TRANSFER_SRC) that was last in use as `use` says.
Result<std::vector<std::byte>> read_image(StandaloneDevice& device, const DeviceImage& image,
                                          const ImageUse& use, VkDeviceSize texel_bytes);

/// Bytes of a texel.
VkDeviceSize texel_bytes(LightmapFormat format);

/// The image that a lightmap pass asks for, with copies allowed; cleared to zero, in layout GENERAL.
Result<DeviceImage> make_lightmap_target(StandaloneDevice& device, const LightmapImage& needed);

}  // namespace relume
