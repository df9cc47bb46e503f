// SPDX-License-Identifier: MIT
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <vector>

#include "core/result.h"

namespace relume {

/// What a host asks for when it creates its instance and device, to be merged with what others need. Today
/// every list is empty: the kernels use 32-bit storage buffers and workgroup memory, which all of Vulkan 1.1
/// has.
struct DeviceRequirements {
  std::uint32_t api_version = VK_API_VERSION_1_1;  ///< at least, in VkApplicationInfo
  std::vector<const char*> device_extensions;
  VkPhysicalDeviceFeatures features{};
  VkQueueFlags queue_flags = VK_QUEUE_COMPUTE_BIT;  ///< of the queue that the command buffers go to
};

/// To be asked before the device is created. Fails with no_device and a sentence that names the device and
/// what it lacks.
Result<DeviceRequirements> device_requirements(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                               VkInstance instance, VkPhysicalDevice physical_device);

}  // namespace relume
