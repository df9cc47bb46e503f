// SPDX-License-Identifier: MIT
#include "compute/host_image.h"

#include <gtest/gtest.h>

#include <cstring>

#include "compute/vulkan_info.h"

namespace relume::test {
namespace {

constexpr VkImageSubresourceRange kWhole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};

std::uint32_t device_local_type(const StandaloneDevice& device, std::uint32_t allowed) {
  const VkPhysicalDeviceMemoryProperties& memory = device.memory_properties();
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    const bool local = (memory.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) != 0;
    if (local && (allowed & (1u << i)) != 0) return i;
  }
  return 0;
}

VkImage make_image(VkDevice device, const ImageShape& shape) {
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
  EXPECT_EQ(vkCreateImage(device, &info, nullptr, &image), VK_SUCCESS);
  return image;
}

}  // namespace

HostImage::HostImage(const StandaloneDevice& device, const ImageShape& shape)
    : device_(device.host().device),
      extent_(shape.extent),
      image_(device_, make_image(device_, shape), vkDestroyImage, nullptr) {
  VkMemoryRequirements needed{};
  vkGetImageMemoryRequirements(device_, image_.get(), &needed);
  auto info = vulkan_info<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  info.allocationSize = needed.size;
  info.memoryTypeIndex = device_local_type(device, needed.memoryTypeBits);
  VkDeviceMemory memory = VK_NULL_HANDLE;
  EXPECT_EQ(vkAllocateMemory(device_, &info, nullptr, &memory), VK_SUCCESS);
  memory_ = VulkanHandle<VkDeviceMemory>(device_, memory, vkFreeMemory, nullptr);
  EXPECT_EQ(vkBindImageMemory(device_, image_.get(), memory, 0), VK_SUCCESS);
}

VkImageView HostImage::view(VkFormat format, VkImageUsageFlags usage) {
  auto narrowed = vulkan_info<VkImageViewUsageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_USAGE_CREATE_INFO);
  narrowed.usage = usage;
  auto info = vulkan_info<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  info.pNext = &narrowed;
  info.image = image_.get();
  info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  info.format = format;
  info.subresourceRange = kWhole;
  VkImageView view = VK_NULL_HANDLE;
  EXPECT_EQ(vkCreateImageView(device_, &info, nullptr, &view), VK_SUCCESS);
  views_.emplace_back(device_, view, vkDestroyImageView, nullptr);
  return view;
}

void HostImage::record_transition(VkCommandBuffer commands, const ImageUse& from, const ImageUse& to) const {
  auto barrier = vulkan_info<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
  barrier.srcAccessMask = from.access;
  barrier.dstAccessMask = to.access;
  barrier.oldLayout = from.layout;
  barrier.newLayout = to.layout;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image_.get();
  barrier.subresourceRange = kWhole;
  vkCmdPipelineBarrier(commands, from.stage, to.stage, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

VkBufferImageCopy HostImage::whole() const {
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {extent_.width, extent_.height, 1};
  return copy;
}

void HostImage::upload(StandaloneDevice& device, std::span<const std::byte> texels, const ImageUse& use) {
  auto staging =
      make_device_buffer(device, texels.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload);
  ASSERT_TRUE(staging) << staging.error().message;
  std::memcpy(staging->mapped, texels.data(), texels.size());
  const VkBufferImageCopy copy = whole();
  const auto submitted = device.submit([&](VkCommandBuffer commands) {
    record_transition(commands, kUndefined, kImageCopyTarget);
    vkCmdCopyBufferToImage(commands, staging->buffer.get(), image_.get(), kImageCopyTarget.layout, 1, &copy);
    record_transition(commands, kImageCopyTarget, use);
  });
  EXPECT_TRUE(submitted) << submitted.error().message;
}

std::vector<std::byte> HostImage::download(StandaloneDevice& device, const ImageUse& use,
                                           VkDeviceSize texel_bytes) {
  const VkDeviceSize bytes = texel_bytes * extent_.width * extent_.height;
  auto readback = make_device_buffer(device, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback);
  EXPECT_TRUE(readback) << readback.error().message;
  const VkBufferImageCopy copy = whole();
  const auto submitted = device.submit([&](VkCommandBuffer commands) {
    record_transition(commands, use, kImageCopySource);
    vkCmdCopyImageToBuffer(commands, image_.get(), kImageCopySource.layout, readback->buffer.get(), 1, &copy);
    record_transition(commands, kImageCopySource, use);
  });
  EXPECT_TRUE(submitted) << submitted.error().message;
  return {readback->mapped, readback->mapped + bytes};
}

HostImage make_lightmap_image(StandaloneDevice& device, const LightmapImage& needed) {
  const VkImageUsageFlags copies = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  HostImage image(device, {needed.format, needed.extent, needed.usage | copies, needed.flags});
  const std::size_t texels = std::size_t{needed.extent.width} * needed.extent.height;
  const std::size_t texel_bytes = needed.format == VK_FORMAT_R16G16B16A16_SFLOAT ? 8 : 4;
  image.upload(device, std::vector<std::byte>(texels * texel_bytes), kImageWritten);
  return image;
}

}  // namespace relume::test
