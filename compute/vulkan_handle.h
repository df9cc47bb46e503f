// SPDX-License-Identifier: MIT
#pragma once

#include <vulkan/vulkan_core.h>

#include <utility>

namespace relume {

/// Owns one object of a device that somebody else owns. The device and the allocation callbacks must outlive
/// it.
template <class Object>
class VulkanHandle {
 public:
  using Destroy = void(VKAPI_PTR*)(VkDevice, Object, const VkAllocationCallbacks*);

  VulkanHandle() = default;
  VulkanHandle(VkDevice device, Object object, Destroy destroy, const VkAllocationCallbacks* callbacks)
      : device_(device), object_(object), destroy_(destroy), callbacks_(callbacks) {}
  VulkanHandle(VulkanHandle&& other) noexcept { swap(other); }
  VulkanHandle& operator=(VulkanHandle&& other) noexcept {
    VulkanHandle(std::move(other)).swap(*this);
    return *this;
  }
  ~VulkanHandle() {
    if (object_ != VK_NULL_HANDLE) destroy_(device_, object_, callbacks_);
  }

  Object get() const { return object_; }

 private:
  void swap(VulkanHandle& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(object_, other.object_);
    std::swap(destroy_, other.destroy_);
    std::swap(callbacks_, other.callbacks_);
  }

  VkDevice device_ = VK_NULL_HANDLE;
  Object object_ = VK_NULL_HANDLE;
  Destroy destroy_ = nullptr;
  const VkAllocationCallbacks* callbacks_ = nullptr;
};

}  // namespace relume
