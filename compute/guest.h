// SPDX-License-Identifier: MIT
//
// What all guests on a host's device do alike.
#pragma once

#include <vulkan/vulkan_core.h>

#include "compute/host_device.h"
#include "core/result.h"

namespace relume {

/// Limits of the device, if it meets device_requirements; else no_device.
Result<VkPhysicalDeviceLimits> device_limits(const HostDevice& host);

}  // namespace relume
