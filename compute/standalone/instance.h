// SPDX-License-Identifier: MIT
//
// The Vulkan instance of a StandaloneDevice, and the choice among its physical devices.
#pragma once

#include <vulkan/vulkan.h>

#include <memory>
#include <string>

#include "compute/standalone/validation_log.h"
#include "core/result.h"

namespace relume {

enum class ValidationKind { none, core_and_synchronization, gpu_assisted };

/// Owns an instance and, when validating, the messenger that feeds `log`.
class Instance {
 public:
  /// `log` must outlive the instance. Without the Khronos layer, validation is left out.
  static Result<Instance> create(ValidationKind validation, ValidationLog& log);

  Instance(Instance&& other) noexcept;
  Instance& operator=(Instance&&) = delete;
  ~Instance();

  VkInstance get() const { return instance_; }
  bool validating() const { return messenger_ != VK_NULL_HANDLE; }

 private:
  Instance() = default;

  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

/// The best device that meets device_requirements and has `name` in its name (any case). Fails with no_device
/// and a sentence that lists what was found and why it was not taken.
Result<VkPhysicalDevice> choose_physical_device(VkInstance instance, const std::string& name);

}  // namespace relume
