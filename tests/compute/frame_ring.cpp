// SPDX-License-Identifier: MIT
#include "compute/frame_ring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "compute/vulkan_info.h"

namespace relume::test {

FrameRing::FrameRing(StandaloneDevice& device, std::uint32_t frames, VkDeviceSize byte_size)
    : device_(device), frames_(frames), slot_(frames - 1) {
  VkDevice owner = device.host().device;
  vkGetDeviceQueue(owner, device.queue_family(), 0, &queue_);
  for (Frame& frame : frames_) {
    auto pool_info = vulkan_info<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
    pool_info.queueFamilyIndex = device.queue_family();
    VkCommandPool pool = VK_NULL_HANDLE;
    EXPECT_EQ(vkCreateCommandPool(owner, &pool_info, nullptr, &pool), VK_SUCCESS);
    frame.pool = {owner, pool, vkDestroyCommandPool, nullptr};
    auto info = vulkan_info<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
    info.commandPool = pool;
    info.commandBufferCount = 1;
    EXPECT_EQ(vkAllocateCommandBuffers(owner, &info, &frame.commands), VK_SUCCESS);
    const auto fence_info = vulkan_info<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
    VkFence fence = VK_NULL_HANDLE;
    EXPECT_EQ(vkCreateFence(owner, &fence_info, nullptr, &fence), VK_SUCCESS);
    frame.fence = {owner, fence, vkDestroyFence, nullptr};
    auto memory = make_device_buffer(device, byte_size,
                                     VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                     MemoryKind::readback);
    EXPECT_TRUE(memory) << memory.error().message;
    frame.memory = std::move(*memory);
  }
}

FrameRing::~FrameRing() {
  wait_for_all();
}

void FrameRing::wait(Frame& frame) {
  if (!frame.submitted) return;
  VkFence fence = frame.fence.get();
  EXPECT_EQ(vkWaitForFences(device_.host().device, 1, &fence, VK_TRUE, 60'000'000'000), VK_SUCCESS);
  EXPECT_EQ(vkResetFences(device_.host().device, 1, &fence), VK_SUCCESS);
  frame.submitted = false;
}

VkCommandBuffer FrameRing::begin() {
  slot_ = (slot_ + 1) % static_cast<std::uint32_t>(frames_.size());
  Frame& frame = frames_[slot_];
  wait(frame);
  frame.used = 0;
  EXPECT_EQ(vkResetCommandPool(device_.host().device, frame.pool.get(), 0), VK_SUCCESS);
  auto begin = vulkan_info<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  EXPECT_EQ(vkBeginCommandBuffer(frame.commands, &begin), VK_SUCCESS);
  return frame.commands;
}

void FrameRing::submit() {
  Frame& frame = frames_[slot_];
  // Results are for the processor once the fence has signalled.
  auto barrier = vulkan_info<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  vkCmdPipelineBarrier(frame.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                       &barrier, 0, nullptr, 0, nullptr);
  EXPECT_EQ(vkEndCommandBuffer(frame.commands), VK_SUCCESS);
  auto info = vulkan_info<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  info.commandBufferCount = 1;
  info.pCommandBuffers = &frame.commands;
  EXPECT_EQ(vkQueueSubmit(queue_, 1, &info, frame.fence.get()), VK_SUCCESS);
  frame.submitted = true;
}

void FrameRing::drop() {
  EXPECT_EQ(vkEndCommandBuffer(frames_[slot_].commands), VK_SUCCESS);
}

void FrameRing::wait_for_all() {
  for (Frame& frame : frames_) wait(frame);
}

std::uint32_t FrameRing::in_flight() const {
  return static_cast<std::uint32_t>(
      std::count_if(frames_.begin(), frames_.end(), [](const Frame& frame) { return frame.submitted; }));
}

BufferRange FrameRing::reserve(VkDeviceSize byte_size) {
  Frame& frame = frames_[slot_];
  const BufferRange range{frame.memory.buffer.get(), frame.used, byte_size};
  frame.used += byte_size;
  EXPECT_LE(frame.used, frame.memory.byte_size);
  return range;
}

BufferRange FrameRing::stage(std::span<const Rgb> values) {
  const BufferRange range = reserve(values.size() * 16);
  std::byte* at = frames_[slot_].memory.mapped + range.offset;
  for (const Rgb& value : values) {
    const std::array<float, 4> texel = {static_cast<float>(value.x), static_cast<float>(value.y),
                                        static_cast<float>(value.z), 0.0f};
    std::memcpy(at, texel.data(), sizeof texel);
    at += sizeof texel;
  }
  return range;
}

Staging FrameRing::staging(VkDeviceSize byte_size) {
  const BufferRange range = reserve(byte_size);
  return {range, frames_[slot_].memory.mapped + range.offset};
}

std::span<const std::byte> FrameRing::bytes(std::uint32_t frame, const BufferRange& range) const {
  return {frames_[frame].memory.mapped + range.offset, range.byte_size};
}

}  // namespace relume::test
