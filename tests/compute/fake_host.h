// SPDX-License-Identifier: MIT
//
// A renderer that owns everything: memory with guards around each buffer, allocation callbacks that count,
// and a vkGetInstanceProcAddr that is not the loader's.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "compute/gpu_solver.h"
#include "compute/standalone/standalone_device.h"
#include "compute/standalone/standalone_memory.h"

namespace relume::test {

/// One large mapped buffer, all bytes 0xff (NaN as floats) at first, of which ranges are handed out with gaps
/// between them. For GPU-assisted validation each is a buffer of its own in the same memory: the layer
/// (1.3.239) sees when a kernel leaves a buffer, but not when it leaves the range that is bound of it.
class GuardedMemory {
 public:
  GuardedMemory(const StandaloneDevice& device, VkDeviceSize byte_size, VkBufferUsageFlags usage);

  /// The first gap that is large enough.
  Result<BufferRange> allocate(const BufferRequirement& requirement);

  /// All bytes are 0xff again.
  void release(const BufferRange& range);

  std::vector<Rgb> read_rgb(const BufferRange& range) const;
  std::span<const std::byte> bytes(const BufferRange& range) const;

  /// Bytes outside of what was handed out that are no longer 0xff.
  std::size_t damaged_bytes() const;
  VkDeviceSize handed_out() const;

 private:
  struct Place {
    VkDeviceSize offset, byte_size;
    VulkanHandle<VkBuffer> buffer;  ///< null: a part of the large one
  };

  VulkanHandle<VkBuffer> buffer_at(VkDeviceSize offset, VkDeviceSize byte_size) const;
  VkDeviceSize offset_of(const BufferRange& range) const;

  VkDevice device_;
  DeviceBuffer buffer_;
  VkBufferUsageFlags usage_;
  std::vector<Place> places_;  ///< ascending
};

/// Host memory of Vulkan objects, counted to the byte.
class CountingCallbacks {
 public:
  CountingCallbacks();
  const VkAllocationCallbacks* get() const { return &callbacks_; }
  int living() const { return living_; }
  int made() const { return made_; }
  std::size_t living_bytes() const { return living_bytes_; }

 private:
  static void* VKAPI_PTR allocate(void* self, std::size_t size, std::size_t alignment,
                                  VkSystemAllocationScope);
  static void* VKAPI_PTR reallocate(void* self, void* original, std::size_t size, std::size_t alignment,
                                    VkSystemAllocationScope);
  static void VKAPI_PTR release(void* self, void* memory);

  VkAllocationCallbacks callbacks_{};
  int living_ = 0;
  int made_ = 0;
  std::size_t living_bytes_ = 0;
  std::map<void*, std::size_t> sizes_;
};

/// One whose devices count their fallible calls, of which one may be told to fail. One test at a time.
PFN_vkVoidFunction VKAPI_PTR get_proc_addr_with_faults(VkInstance instance, const char* name);

/// From now on the `call`-th fallible call of such a device (from 0) gives `result` and does nothing; none
/// for a negative number. Counting starts anew.
void inject_fault(int call, VkResult result);

/// Fallible calls since then, and the name of the one that failed.
int fallible_calls();
std::string failed_call();

/// A vkGetInstanceProcAddr whose devices have a vkCmdPipelineBarrier that does nothing.
PFN_vkVoidFunction VKAPI_PTR get_proc_addr_without_barriers(VkInstance instance, const char* name);

/// One whose devices lack vkCmdFillBuffer.
PFN_vkVoidFunction VKAPI_PTR get_proc_addr_without_fill(VkInstance instance, const char* name);

/// One whose physical devices have texel buffers of at most 65 536 elements, the least that Vulkan allows.
PFN_vkVoidFunction VKAPI_PTR get_proc_addr_of_short_texel_buffers(VkInstance instance, const char* name);

/// One whose physical devices let a stage see 4 storage buffers, the least that Vulkan allows.
PFN_vkVoidFunction VKAPI_PTR get_proc_addr_of_few_storage_buffers(VkInstance instance, const char* name);

}  // namespace relume::test
