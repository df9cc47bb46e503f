// SPDX-License-Identifier: MIT
#include "compute/standalone/standalone_memory.h"

#include <vulkan/vulkan.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "compute/vulkan_error.h"
#include "compute/vulkan_info.h"

namespace relume {
namespace {

constexpr VkDeviceSize kChunkBytes = VkDeviceSize{64} << 20;
constexpr std::uint32_t kNoMemoryType = ~0u;

/// The first memory type among `allowed` that has all of `properties`.
std::uint32_t find_memory_type(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
                               VkMemoryPropertyFlags properties) {
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    const bool fits = (memory.memoryTypes[i].propertyFlags & properties) == properties;
    if ((allowed & (1u << i)) != 0 && fits) return i;
  }
  return kNoMemoryType;
}

/// What is best for `kind`, or else what does.
std::uint32_t memory_type(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
                          MemoryKind kind) {
  constexpr VkMemoryPropertyFlags kMapped =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  const VkMemoryPropertyFlags needed = kind == MemoryKind::device ? 0 : kMapped;
  VkMemoryPropertyFlags wanted = needed;
  if (kind == MemoryKind::device) wanted = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
  if (kind == MemoryKind::readback) wanted = kMapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  const std::uint32_t best = find_memory_type(memory, allowed, wanted);
  return best != kNoMemoryType ? best : find_memory_type(memory, allowed, needed);
}

Result<VulkanHandle<VkBuffer>> make_buffer(VkDevice device, VkDeviceSize byte_size,
                                           VkBufferUsageFlags usage) {
  auto info = vulkan_info<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = byte_size;
  info.usage = usage;
  VkBuffer buffer = VK_NULL_HANDLE;
  const VkResult result = vkCreateBuffer(device, &info, nullptr, &buffer);
  if (result != VK_SUCCESS) {
    return tl::unexpected<Error>(
        vulkan_error(result, "creating a buffer of " + std::to_string(byte_size) + " bytes"));
  }
  return VulkanHandle<VkBuffer>(device, buffer, vkDestroyBuffer, nullptr);
}

Result<VulkanHandle<VkDeviceMemory>> make_memory(VkDevice device, VkDeviceSize byte_size,
                                                 std::uint32_t type) {
  auto info = vulkan_info<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  info.allocationSize = byte_size;
  info.memoryTypeIndex = type;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  const VkResult result = vkAllocateMemory(device, &info, nullptr, &memory);
  if (result != VK_SUCCESS) {
    return tl::unexpected<Error>(
        vulkan_error(result, "allocating " + std::to_string(byte_size) + " bytes of device memory"));
  }
  return VulkanHandle<VkDeviceMemory>(device, memory, vkFreeMemory, nullptr);
}

Result<void> bind_and_map(VkDevice device, DeviceBuffer& buffer, MemoryKind kind) {
  if (auto bound = check_vulkan(vkBindBufferMemory(device, buffer.buffer.get(), buffer.memory.get(), 0),
                                "binding memory to a buffer");
      !bound || kind == MemoryKind::device) {
    return bound;
  }
  void* address = nullptr;
  const VkResult mapped = vkMapMemory(device, buffer.memory.get(), 0, VK_WHOLE_SIZE, 0, &address);
  buffer.mapped = static_cast<std::byte*>(address);
  return check_vulkan(mapped, "mapping memory");
}

}  // namespace

Result<DeviceBuffer> make_device_buffer(const StandaloneDevice& device, VkDeviceSize byte_size,
                                        VkBufferUsageFlags usage, MemoryKind kind) {
  VkDevice owner = device.host().device;
  DeviceBuffer result;
  result.byte_size = byte_size;
  auto buffer = make_buffer(owner, byte_size, usage);
  if (!buffer) return tl::unexpected<Error>(buffer.error());
  result.buffer = std::move(*buffer);

  VkMemoryRequirements requirements{};
  vkGetBufferMemoryRequirements(owner, result.buffer.get(), &requirements);
  const std::uint32_t type = memory_type(device.memory_properties(), requirements.memoryTypeBits, kind);
  if (type == kNoMemoryType) {
    return fail(ErrorCode::no_device,
                "the device '" + device.name() + "' has no memory that the processor can map");
  }
  auto memory = make_memory(owner, requirements.size, type);
  if (!memory) return tl::unexpected<Error>(memory.error());
  result.memory = std::move(*memory);
  if (auto bound = bind_and_map(owner, result, kind); !bound) return tl::unexpected<Error>(bound.error());
  return result;
}

Result<std::vector<float>> read_floats(StandaloneDevice& device, const BufferRange& range,
                                       std::size_t count) {
  std::vector<float> values(count);
  if (count == 0) return values;
  const VkDeviceSize bytes = count * sizeof(float);
  auto readback = make_device_buffer(device, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback);
  if (!readback) return tl::unexpected<Error>(readback.error());
  const auto times = device.submit([&](VkCommandBuffer commands) {
    const VkBufferCopy copy{range.offset, 0, bytes};
    vkCmdCopyBuffer(commands, range.buffer, readback->buffer.get(), 1, &copy);
    auto barrier = vulkan_info<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier,
                         0, nullptr, 0, nullptr);
  });
  if (!times) return tl::unexpected<Error>(times.error());
  std::memcpy(values.data(), readback->mapped, bytes);
  return values;
}

Result<BufferRange> DeviceArena::allocate(const BufferRequirement& requirement) {
  VkDeviceSize offset = (used_ + requirement.alignment - 1) / requirement.alignment * requirement.alignment;
  if (chunks_.empty() || offset + requirement.byte_size > chunks_.back().byte_size) {
    auto chunk = make_device_buffer(*device_, std::max(kChunkBytes, requirement.byte_size), requirement.usage,
                                    MemoryKind::device);
    if (!chunk) return tl::unexpected<Error>(chunk.error());
    chunks_.push_back(std::move(*chunk));
    offset = 0;
  }
  used_ = offset + requirement.byte_size;
  return BufferRange{chunks_.back().buffer.get(), offset, requirement.byte_size};
}

VkDeviceSize DeviceArena::byte_size() const {
  VkDeviceSize total = 0;
  for (const DeviceBuffer& chunk : chunks_) total += chunk.byte_size;
  return total;
}

}  // namespace relume
