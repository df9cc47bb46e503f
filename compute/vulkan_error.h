// SPDX-License-Identifier: MIT
#pragma once

#include <vulkan/vulkan_core.h>

#include <string>

#include "core/result.h"

namespace relume {

/// The error for a call that did not give VK_SUCCESS: out_of_memory when memory ran out, else no_device.
/// `what` says what was being done, as in "creating a pipeline".
Error vulkan_error(VkResult result, const std::string& what);

/// Nothing when `result` is VK_SUCCESS, else vulkan_error.
Result<void> check_vulkan(VkResult result, const std::string& what);

}  // namespace relume
