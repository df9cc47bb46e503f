// SPDX-License-Identifier: MIT
#pragma once

#include <vulkan/vulkan_core.h>

#include <string>

namespace relume {

/// A device that somebody else owns. All of it is borrowed and must outlive what is made from it; nothing is
/// created on it but shader modules, layouts, pipelines and descriptor pools.
struct HostDevice {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  VkPipelineCache pipeline_cache = VK_NULL_HANDLE;              ///< may be null
  const VkAllocationCallbacks* allocation_callbacks = nullptr;  ///< may be null
};

/// A buffer that a solver needs and the host provides.
struct BufferRequirement {
  std::string name;  ///< "radiosity a", "system 2 bounce block 0", ...
  VkDeviceSize byte_size = 0;
  VkDeviceSize alignment = 0;  ///< of the offset of the range that is bound
  VkBufferUsageFlags usage = 0;
};

/// A part of a buffer of the host.
struct BufferRange {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;
  VkDeviceSize byte_size = 0;
};

}  // namespace relume
