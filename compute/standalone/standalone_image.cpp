// SPDX-License-Identifier: MIT
#include "compute/standalone/standalone_image.h"

#include <vulkan/vulkan.h>

#include <cstring>
#include <string>

#include "compute/standalone/standalone_memory.h"
#include "compute/vulkan_error.h"
#include "compute/vulkan_info.h"

namespace relume {
namespace {

constexpr VkImageSubresourceRange kWhole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};

/// The first device-local type, or the first.
std::uint32_t memory_type(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed) {
  std::uint32_t first = memory.memoryTypeCount;
  for (std::uint32_t i = memory.memoryTypeCount; i-- > 0;) {
    if ((allowed & (1u << i)) != 0) first = i;
  }
  for (std::uint32_t i = first; i < memory.memoryTypeCount; ++i) {
    const bool local = (memory.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) != 0;
    if (local && (allowed & (1u << i)) != 0) return i;
  }
  return first;
}

Result<VulkanHandle<VkImage>> make_image(VkDevice device, const ImageShape& shape) {
  auto info = vulkan_info<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.flags = shape.flags;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = shape.format;
  info.extent = {shape.extent.width, shape.extent.height, 1};
  info.mipLevels = 1;
  info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = shape.usage;
  VkImage image = VK_NULL_HANDLE;
  const auto made = check_vulkan(vkCreateImage(device, &info, nullptr, &image),
                                 "creating an image of " + std::to_string(shape.extent.width) + " x " +
                                     std::to_string(shape.extent.height));
  if (!made) return fail(made.error());
  return VulkanHandle<VkImage>(device, image, vkDestroyImage, nullptr);
}

VkBufferImageCopy whole(const DeviceImage& image) {
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {image.extent.width, image.extent.height, 1};
  return copy;
}

}  // namespace

Result<DeviceImage> make_device_image(const StandaloneDevice& device, const ImageShape& shape) {
  VkDevice owner = device.host().device;
  auto image = make_image(owner, shape);
  if (!image) return fail(image.error());
  VkMemoryRequirements needed{};
  vkGetImageMemoryRequirements(owner, image->get(), &needed);
  auto info = vulkan_info<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  info.allocationSize = needed.size;
  info.memoryTypeIndex = memory_type(device.memory_properties(), needed.memoryTypeBits);
  DeviceImage result;
  result.extent = shape.extent;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  if (auto made = check_vulkan(vkAllocateMemory(owner, &info, nullptr, &memory), "allocating an image");
      !made)
    return fail(made.error());
  result.memory = VulkanHandle<VkDeviceMemory>(owner, memory, vkFreeMemory, nullptr);
  result.image = std::move(*image);
  if (auto bound =
          check_vulkan(vkBindImageMemory(owner, result.image.get(), memory, 0), "binding memory to an image");
      !bound)
    return fail(bound.error());
  return result;
}

Result<VulkanHandle<VkImageView>> make_image_view(const StandaloneDevice& device, const DeviceImage& image,
                                                  VkFormat format, VkImageUsageFlags usage) {
  auto narrowed = vulkan_info<VkImageViewUsageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_USAGE_CREATE_INFO);
  narrowed.usage = usage;
  auto info = vulkan_info<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  info.pNext = &narrowed;
  info.image = image.image.get();
  info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  info.format = format;
  info.subresourceRange = kWhole;
  VkDevice owner = device.host().device;
  VkImageView view = VK_NULL_HANDLE;
  if (auto made = check_vulkan(vkCreateImageView(owner, &info, nullptr, &view), "creating an image view");
      !made)
    return fail(made.error());
  return VulkanHandle<VkImageView>(owner, view, vkDestroyImageView, nullptr);
}

void record_transition(VkCommandBuffer commands, const DeviceImage& image, const ImageUse& from,
                       const ImageUse& to) {
  auto barrier = vulkan_info<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
  barrier.srcAccessMask = from.access;
  barrier.dstAccessMask = to.access;
  barrier.oldLayout = from.layout;
  barrier.newLayout = to.layout;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.image.get();
  barrier.subresourceRange = kWhole;
  vkCmdPipelineBarrier(commands, from.stage, to.stage, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

Result<void> write_image(StandaloneDevice& device, const DeviceImage& image,
                         std::span<const std::byte> texels, const ImageUse& use) {
  auto staging =
      make_device_buffer(device, texels.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload);
  if (!staging) return fail(staging.error());
  std::memcpy(staging->mapped, texels.data(), texels.size());
  const VkBufferImageCopy copy = whole(image);
  const auto submitted = device.submit([&](VkCommandBuffer commands) {
    record_transition(commands, image, kUndefined, kImageCopyTarget);
    vkCmdCopyBufferToImage(commands, staging->buffer.get(), image.image.get(), kImageCopyTarget.layout, 1,
                           &copy);
    record_transition(commands, image, kImageCopyTarget, use);
  });
  if (!submitted) return fail(submitted.error());
  return {};
}

Result<std::vector<std::byte>> read_image(StandaloneDevice& device, const DeviceImage& image,
                                          const ImageUse& use, VkDeviceSize texel_byte_count) {
  const VkDeviceSize bytes = texel_byte_count * image.extent.width * image.extent.height;
  auto readback = make_device_buffer(device, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback);
  if (!readback) return fail(readback.error());
  const VkBufferImageCopy copy = whole(image);
  const auto submitted = device.submit([&](VkCommandBuffer commands) {
    record_transition(commands, image, use, kImageCopySource);
    vkCmdCopyImageToBuffer(commands, image.image.get(), kImageCopySource.layout, readback->buffer.get(), 1,
                           &copy);
    record_transition(commands, image, kImageCopySource, use);
  });
  if (!submitted) return fail(submitted.error());
  return std::vector<std::byte>(readback->mapped, readback->mapped + bytes);
}

VkDeviceSize texel_bytes(LightmapFormat format) {
  return format == LightmapFormat::rgba16f || format == LightmapFormat::direction_rgba16f ? 8 : 4;
}

Result<DeviceImage> make_lightmap_target(StandaloneDevice& device, const LightmapImage& needed) {
  const VkImageUsageFlags copies = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  auto image = make_device_image(device, {needed.format, needed.extent, needed.usage | copies, needed.flags});
  if (!image) return image;
  const std::size_t texels = std::size_t{needed.extent.width} * needed.extent.height;
  const std::size_t bytes = needed.format == VK_FORMAT_R16G16B16A16_SFLOAT ? 8 : 4;
  const std::vector<std::byte> black(texels * bytes);
  if (auto written = write_image(device, *image, black, kImageWritten); !written)
    return fail(written.error());
  return image;
}

}  // namespace relume
