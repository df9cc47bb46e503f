// SPDX-License-Identifier: MIT
#include "compute/vulkan_error.h"

namespace relume {
namespace {

const char* describe(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "the host is out of memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "the device is out of memory";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
      return "the descriptor pool is out of memory";
    case VK_ERROR_FRAGMENTATION:
      return "the memory is too fragmented";
    case VK_ERROR_DEVICE_LOST:
      return "the device was lost";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "initialization failed";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "a layer is not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "an extension is not present";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "a feature is not present";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "no Vulkan driver is installed, or it is incompatible";
    case VK_ERROR_TOO_MANY_OBJECTS:
      return "there are too many objects";
    case VK_TIMEOUT:
      return "it did not finish in time";
    default:
      return "Vulkan refused";
  }
}

bool is_memory(VkResult result) {
  return result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY ||
         result == VK_ERROR_OUT_OF_POOL_MEMORY || result == VK_ERROR_FRAGMENTATION;
}

}  // namespace

Error vulkan_error(VkResult result, const std::string& what) {
  return {is_memory(result) ? ErrorCode::out_of_memory : ErrorCode::no_device,
          what + " failed: " + describe(result) + " (VkResult " + std::to_string(result) + ")"};
}

Result<void> check_vulkan(VkResult result, const std::string& what) {
  if (result == VK_SUCCESS) return {};
  return tl::unexpected<Error>(vulkan_error(result, what));
}

}  // namespace relume
