// SPDX-License-Identifier: MIT
#include "compute/fake_host.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "compute/device_fixture.h"
#include "compute/vulkan_info.h"

namespace relume::test {
namespace {

constexpr std::byte kGuard{0xff};
constexpr VkDeviceSize kGap = 512;
constexpr VkDeviceSize kPlacement = 256;  ///< that buffers of their own need

VKAPI_ATTR void VKAPI_CALL no_barrier(VkCommandBuffer, VkPipelineStageFlags, VkPipelineStageFlags,
                                      VkDependencyFlags, std::uint32_t, const VkMemoryBarrier*, std::uint32_t,
                                      const VkBufferMemoryBarrier*, std::uint32_t,
                                      const VkImageMemoryBarrier*) {}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_without_barriers(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkCmdPipelineBarrier") == 0) return reinterpret_cast<PFN_vkVoidFunction>(no_barrier);
  return vkGetDeviceProcAddr(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_without_fill(VkDevice device, const char* name) {
  return std::strcmp(name, "vkCmdFillBuffer") == 0 ? nullptr : vkGetDeviceProcAddr(device, name);
}

VKAPI_ATTR void VKAPI_CALL short_texel_buffers(VkPhysicalDevice device,
                                               VkPhysicalDeviceProperties* properties) {
  vkGetPhysicalDeviceProperties(device, properties);
  properties->limits.maxTexelBufferElements = 65536;
}

VKAPI_ATTR void VKAPI_CALL few_storage_buffers(VkPhysicalDevice device,
                                               VkPhysicalDeviceProperties* properties) {
  vkGetPhysicalDeviceProperties(device, properties);
  properties->limits.maxPerStageDescriptorStorageBuffers = 4;
}

/// `replacement` for the entry point called `replaced`, the loader's for all others.
template <class Function>
PFN_vkVoidFunction replace(const char* replaced, Function replacement, VkInstance instance,
                           const char* name) {
  if (std::strcmp(name, replaced) == 0) return reinterpret_cast<PFN_vkVoidFunction>(replacement);
  return vkGetInstanceProcAddr(instance, name);
}

}  // namespace

GuardedMemory::GuardedMemory(const StandaloneDevice& device, VkDeviceSize byte_size, VkBufferUsageFlags usage)
    : device_(device.host().device), usage_(usage) {
  auto made = make_device_buffer(device, byte_size, usage, MemoryKind::readback);
  if (!made) return;
  buffer_ = std::move(*made);
  std::fill_n(buffer_.mapped, byte_size, kGuard);
}

Result<BufferRange> GuardedMemory::allocate(const BufferRequirement& requirement) {
  const VkDeviceSize alignment = std::max(requirement.alignment, kPlacement);
  VkDeviceSize end = 0;
  auto next = places_.begin();
  const auto offset = [&] { return (end + kGap + alignment - 1) / alignment * alignment; };
  for (; next != places_.end() && offset() + requirement.byte_size + kGap > next->offset; ++next)
    end = next->offset + next->byte_size;
  if ((requirement.usage & ~usage_) != 0 || offset() + requirement.byte_size + kGap > buffer_.byte_size) {
    return fail(ErrorCode::out_of_memory, "the fake host has no memory for '" + requirement.name + "'");
  }
  Place place{offset(), requirement.byte_size, {}};
  BufferRange range{buffer_.buffer.get(), place.offset, place.byte_size};
  if (kGpuAssisted) {
    place.buffer = buffer_at(place.offset, place.byte_size);
    range = {place.buffer.get(), 0, place.byte_size};
  }
  places_.insert(next, std::move(place));
  return range;
}

VulkanHandle<VkBuffer> GuardedMemory::buffer_at(VkDeviceSize offset, VkDeviceSize byte_size) const {
  auto info = vulkan_info<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = byte_size;
  info.usage = usage_;
  VkBuffer buffer = VK_NULL_HANDLE;
  EXPECT_EQ(vkCreateBuffer(device_, &info, nullptr, &buffer), VK_SUCCESS);
  VkMemoryRequirements needed{};
  vkGetBufferMemoryRequirements(device_, buffer, &needed);
  EXPECT_EQ(offset % needed.alignment, 0u);
  EXPECT_EQ(vkBindBufferMemory(device_, buffer, buffer_.memory.get(), offset), VK_SUCCESS);
  return {device_, buffer, vkDestroyBuffer, nullptr};
}

VkDeviceSize GuardedMemory::offset_of(const BufferRange& range) const {
  for (const Place& place : places_) {
    if (place.buffer.get() != VK_NULL_HANDLE && place.buffer.get() == range.buffer)
      return place.offset + range.offset;
  }
  return range.offset;
}

void GuardedMemory::release(const BufferRange& range) {
  const VkDeviceSize offset = offset_of(range);
  std::erase_if(places_, [&](const Place& place) { return place.offset == offset; });
  std::fill_n(buffer_.mapped + offset, range.byte_size, kGuard);
}

std::span<const std::byte> GuardedMemory::bytes(const BufferRange& range) const {
  return {buffer_.mapped + offset_of(range), range.byte_size};
}

std::vector<Rgb> GuardedMemory::read_rgb(const BufferRange& range) const {
  std::vector<Rgb> values;
  for (VkDeviceSize at = 0; at < range.byte_size; at += 16) {
    std::array<float, 4> texel{};
    std::memcpy(&texel, bytes(range).data() + at, sizeof texel);
    values.emplace_back(texel[0], texel[1], texel[2]);
  }
  return values;
}

std::size_t GuardedMemory::damaged_bytes() const {
  std::size_t damaged = 0;
  VkDeviceSize begin = 0;
  const auto count = [&](VkDeviceSize end) {
    damaged += static_cast<std::size_t>(std::count_if(buffer_.mapped + begin, buffer_.mapped + end,
                                                      [](std::byte byte) { return byte != kGuard; }));
  };
  for (const Place& place : places_) {
    count(place.offset);
    begin = place.offset + place.byte_size;
  }
  count(buffer_.byte_size);
  return damaged;
}

VkDeviceSize GuardedMemory::handed_out() const {
  VkDeviceSize sum = 0;
  for (const Place& place : places_) sum += place.byte_size;
  return sum;
}

CountingCallbacks::CountingCallbacks() {
  callbacks_.pUserData = this;
  callbacks_.pfnAllocation = allocate;
  callbacks_.pfnReallocation = reallocate;
  callbacks_.pfnFree = release;
}

void* CountingCallbacks::allocate(void* self, std::size_t size, std::size_t alignment,
                                  VkSystemAllocationScope) {
  auto& counter = *static_cast<CountingCallbacks*>(self);
  ++counter.living_;
  ++counter.made_;
  const std::size_t whole = std::max(alignment, sizeof(void*));
  void* memory = std::aligned_alloc(whole, (size + whole - 1) / whole * whole);
  counter.sizes_[memory] = size;
  counter.living_bytes_ += size;
  return memory;
}

void* CountingCallbacks::reallocate(void* self, void* original, std::size_t size, std::size_t alignment,
                                    VkSystemAllocationScope scope) {
  void* memory = allocate(self, size, alignment, scope);
  if (original == nullptr) return memory;
  auto& counter = *static_cast<CountingCallbacks*>(self);
  std::memcpy(memory, original, std::min(size, counter.sizes_[original]));
  release(self, original);
  return memory;
}

void CountingCallbacks::release(void* self, void* memory) {
  if (memory == nullptr) return;
  auto& counter = *static_cast<CountingCallbacks*>(self);
  --counter.living_;
  counter.living_bytes_ -= counter.sizes_[memory];
  counter.sizes_.erase(memory);
  std::free(memory);
}

PFN_vkVoidFunction get_proc_addr_without_barriers(VkInstance instance, const char* name) {
  return replace("vkGetDeviceProcAddr", device_without_barriers, instance, name);
}

PFN_vkVoidFunction get_proc_addr_without_fill(VkInstance instance, const char* name) {
  return replace("vkGetDeviceProcAddr", device_without_fill, instance, name);
}

PFN_vkVoidFunction get_proc_addr_of_short_texel_buffers(VkInstance instance, const char* name) {
  return replace("vkGetPhysicalDeviceProperties", short_texel_buffers, instance, name);
}

PFN_vkVoidFunction get_proc_addr_of_few_storage_buffers(VkInstance instance, const char* name) {
  return replace("vkGetPhysicalDeviceProperties", few_storage_buffers, instance, name);
}

}  // namespace relume::test
