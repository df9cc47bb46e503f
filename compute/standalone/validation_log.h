// SPDX-License-Identifier: MIT
#pragma once

#include <vulkan/vulkan_core.h>

#include <mutex>
#include <string>
#include <vector>

namespace relume {

/// Collects the warnings and errors of the validation layer. Must stay where it is while a messenger knows
/// it.
class ValidationLog {
 public:
  ValidationLog() = default;
  ValidationLog(const ValidationLog&) = delete;
  ValidationLog& operator=(const ValidationLog&) = delete;

  std::vector<std::string> messages() const;

  /// For vkCreateDebugUtilsMessengerEXT, and for the chain of VkInstanceCreateInfo.
  VkDebugUtilsMessengerCreateInfoEXT messenger_info();

 private:
  static VKAPI_ATTR VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                VkDebugUtilsMessageTypeFlagsEXT types,
                                                const VkDebugUtilsMessengerCallbackDataEXT* data, void* log);

  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
};

}  // namespace relume
