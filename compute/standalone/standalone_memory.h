// SPDX-License-Identifier: MIT
//
// Memory of a StandaloneDevice.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <vector>

#include "compute/host_device.h"
#include "compute/standalone/standalone_device.h"
#include "compute/vulkan_handle.h"
#include "core/result.h"

namespace relume {

enum class MemoryKind {
  device,    ///< fastest for the device
  upload,    ///< the processor writes
  readback,  ///< the processor reads
};

/// A buffer with memory of its own. The device must outlive it.
struct DeviceBuffer {
  VulkanHandle<VkDeviceMemory> memory;
  VulkanHandle<VkBuffer> buffer;
  VkDeviceSize byte_size = 0;
  std::byte* mapped = nullptr;  ///< null for MemoryKind::device; coherent

  BufferRange range() const { return {buffer.get(), 0, byte_size}; }
};

/// Fails with out_of_memory.
Result<DeviceBuffer> make_device_buffer(const StandaloneDevice& device, VkDeviceSize byte_size,
                                        VkBufferUsageFlags usage, MemoryKind kind);

/// The first `count` floats of a range with usage TRANSFER_SRC, written by compute or copies of earlier
/// submissions.
Result<std::vector<float>> read_floats(StandaloneDevice& device, const BufferRange& range, std::size_t count);

/// Hands out parts of large buffers, so that a model of many blocks needs few allocations. All is freed at
/// once, with it.
class DeviceArena {
 public:
  /// The device must outlive the arena.
  explicit DeviceArena(const StandaloneDevice& device) : device_(&device) {}

  /// Fits GpuSolver::bind.
  Result<BufferRange> allocate(const BufferRequirement& requirement);

  VkDeviceSize byte_size() const;  ///< of all buffers

 private:
  const StandaloneDevice* device_;
  std::vector<DeviceBuffer> chunks_;
  VkDeviceSize used_ = 0;  ///< of the last chunk
};

}  // namespace relume
