// SPDX-License-Identifier: MIT
//
// The frames in flight of a fake renderer: command buffers, fences and host-visible memory, one of each per
// frame.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <span>
#include <vector>

#include "compute/host_device.h"
#include "compute/standalone/standalone_device.h"
#include "compute/standalone/standalone_memory.h"
#include "compute/upload.h"
#include "compute/vulkan_handle.h"
#include "core/quantities.h"

namespace relume::test {

class FrameRing {
 public:
  /// `frames` in flight at most, each with so many bytes of memory that copies read and results go to.
  FrameRing(StandaloneDevice& device, std::uint32_t frames, VkDeviceSize byte_size);
  ~FrameRing();

  /// Waits until the frame that last had this slot is done; its command buffer is recording then.
  VkCommandBuffer begin();
  /// Ends and submits; does not wait.
  void submit();
  /// Ends, and never submits.
  void drop();
  void wait_for_all();

  /// Frames that were submitted and whose fences were not waited for.
  std::uint32_t in_flight() const;

  /// Writes four floats per value into the memory of the frame being recorded, behind what it holds.
  BufferRange stage(std::span<const Rgb> values);
  /// A range of it that a copy may fill, and what is in it when the frame is done.
  BufferRange reserve(VkDeviceSize byte_size);
  /// The same as staging memory.
  Staging staging(VkDeviceSize byte_size);
  std::span<const std::byte> bytes(std::uint32_t frame, const BufferRange& range) const;
  /// Number of the slot being recorded.
  std::uint32_t slot() const { return slot_; }

 private:
  struct Frame {
    VulkanHandle<VkCommandPool> pool;
    VulkanHandle<VkFence> fence;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    DeviceBuffer memory;
    VkDeviceSize used = 0;
    bool submitted = false;
  };

  void wait(Frame& frame);

  StandaloneDevice& device_;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::vector<Frame> frames_;
  std::uint32_t slot_ = 0;
};

}  // namespace relume::test
