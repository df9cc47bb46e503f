// SPDX-License-Identifier: MIT
//
// Every call of Vulkan that a device of our own makes, from the instance to the last wait, is made to fail:
// one error comes out, and nothing is left behind. This program's entry points stand before the loader's.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <map>
#include <string>

#include "compute/standalone/solve_on_device.h"
#include "compute/standalone/standalone_device.h"
#include "compute/test_models.h"

namespace relume::test {
namespace {

struct Faults {
  std::string failing;  ///< this one's call
  int call = -1;        ///< of so many before
  VkResult result = VK_SUCCESS;
  bool failed = false;
  std::map<std::string, int> calls;
  int living = 0;  ///< objects made and not destroyed
};

// Vulkan's entry points carry no pointer of the caller's.
Faults faults;

template <class Function>
Function loader(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// Adds `made` to what lives when the call succeeds.
template <class Function, class... Arguments>
VkResult call(const char* name, int made, Arguments... arguments) {
  const int before = faults.calls[name]++;
  if (name == faults.failing && before == faults.call) {
    faults.failed = true;
    return faults.result;
  }
  const VkResult result = loader<Function>(name)(arguments...);
  if (result == VK_SUCCESS) faults.living += made;
  return result;
}

template <class Function, class Handle, class... Arguments>
void destroy(const char* name, Handle handle, Arguments... arguments) {
  if (handle != VK_NULL_HANDLE) --faults.living;
  loader<Function>(name)(arguments...);
}

}  // namespace
}  // namespace relume::test

using relume::test::call;
using relume::test::destroy;

extern "C" {

VkResult vkCreateInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* with,
                          VkInstance* made) {
  return call<PFN_vkCreateInstance>("vkCreateInstance", 1, info, with, made);
}
void vkDestroyInstance(VkInstance instance, const VkAllocationCallbacks* with) {
  destroy<PFN_vkDestroyInstance>("vkDestroyInstance", instance, instance, with);
}
VkResult vkEnumeratePhysicalDevices(VkInstance instance, std::uint32_t* count, VkPhysicalDevice* devices) {
  return call<PFN_vkEnumeratePhysicalDevices>("vkEnumeratePhysicalDevices", 0, instance, count, devices);
}
VkResult vkCreateDevice(VkPhysicalDevice from, const VkDeviceCreateInfo* info,
                        const VkAllocationCallbacks* with, VkDevice* made) {
  return call<PFN_vkCreateDevice>("vkCreateDevice", 1, from, info, with, made);
}
void vkDestroyDevice(VkDevice device, const VkAllocationCallbacks* with) {
  destroy<PFN_vkDestroyDevice>("vkDestroyDevice", device, device, with);
}
VkResult vkCreateCommandPool(VkDevice device, const VkCommandPoolCreateInfo* info,
                             const VkAllocationCallbacks* with, VkCommandPool* made) {
  return call<PFN_vkCreateCommandPool>("vkCreateCommandPool", 1, device, info, with, made);
}
void vkDestroyCommandPool(VkDevice device, VkCommandPool pool, const VkAllocationCallbacks* with) {
  destroy<PFN_vkDestroyCommandPool>("vkDestroyCommandPool", pool, device, pool, with);
}
VkResult vkAllocateCommandBuffers(VkDevice device, const VkCommandBufferAllocateInfo* info,
                                  VkCommandBuffer* made) {
  return call<PFN_vkAllocateCommandBuffers>("vkAllocateCommandBuffers", 0, device, info, made);
}
VkResult vkCreateFence(VkDevice device, const VkFenceCreateInfo* info, const VkAllocationCallbacks* with,
                       VkFence* made) {
  return call<PFN_vkCreateFence>("vkCreateFence", 1, device, info, with, made);
}
void vkDestroyFence(VkDevice device, VkFence fence, const VkAllocationCallbacks* with) {
  destroy<PFN_vkDestroyFence>("vkDestroyFence", fence, device, fence, with);
}
VkResult vkCreateQueryPool(VkDevice device, const VkQueryPoolCreateInfo* info,
                           const VkAllocationCallbacks* with, VkQueryPool* made) {
  return call<PFN_vkCreateQueryPool>("vkCreateQueryPool", 1, device, info, with, made);
}
void vkDestroyQueryPool(VkDevice device, VkQueryPool pool, const VkAllocationCallbacks* with) {
  destroy<PFN_vkDestroyQueryPool>("vkDestroyQueryPool", pool, device, pool, with);
}
VkResult vkGetQueryPoolResults(VkDevice device, VkQueryPool pool, std::uint32_t first, std::uint32_t count,
                               std::size_t bytes, void* data, VkDeviceSize stride, VkQueryResultFlags flags) {
  return call<PFN_vkGetQueryPoolResults>("vkGetQueryPoolResults", 0, device, pool, first, count, bytes, data,
                                         stride, flags);
}
VkResult vkCreateBuffer(VkDevice device, const VkBufferCreateInfo* info, const VkAllocationCallbacks* with,
                        VkBuffer* made) {
  return call<PFN_vkCreateBuffer>("vkCreateBuffer", 1, device, info, with, made);
}
void vkDestroyBuffer(VkDevice device, VkBuffer buffer, const VkAllocationCallbacks* with) {
  destroy<PFN_vkDestroyBuffer>("vkDestroyBuffer", buffer, device, buffer, with);
}
VkResult vkAllocateMemory(VkDevice device, const VkMemoryAllocateInfo* info,
                          const VkAllocationCallbacks* with, VkDeviceMemory* made) {
  return call<PFN_vkAllocateMemory>("vkAllocateMemory", 1, device, info, with, made);
}
void vkFreeMemory(VkDevice device, VkDeviceMemory memory, const VkAllocationCallbacks* with) {
  destroy<PFN_vkFreeMemory>("vkFreeMemory", memory, device, memory, with);
}
VkResult vkBindBufferMemory(VkDevice device, VkBuffer buffer, VkDeviceMemory memory, VkDeviceSize offset) {
  return call<PFN_vkBindBufferMemory>("vkBindBufferMemory", 0, device, buffer, memory, offset);
}
VkResult vkMapMemory(VkDevice device, VkDeviceMemory memory, VkDeviceSize offset, VkDeviceSize bytes,
                     VkMemoryMapFlags flags, void** data) {
  return call<PFN_vkMapMemory>("vkMapMemory", 0, device, memory, offset, bytes, flags, data);
}
VkResult vkResetCommandPool(VkDevice device, VkCommandPool pool, VkCommandPoolResetFlags flags) {
  return call<PFN_vkResetCommandPool>("vkResetCommandPool", 0, device, pool, flags);
}
VkResult vkBeginCommandBuffer(VkCommandBuffer commands, const VkCommandBufferBeginInfo* info) {
  return call<PFN_vkBeginCommandBuffer>("vkBeginCommandBuffer", 0, commands, info);
}
VkResult vkEndCommandBuffer(VkCommandBuffer commands) {
  return call<PFN_vkEndCommandBuffer>("vkEndCommandBuffer", 0, commands);
}
VkResult vkQueueSubmit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* submits, VkFence fence) {
  return call<PFN_vkQueueSubmit>("vkQueueSubmit", 0, queue, count, submits, fence);
}
VkResult vkWaitForFences(VkDevice device, std::uint32_t count, const VkFence* fences, VkBool32 all,
                         std::uint64_t timeout) {
  return call<PFN_vkWaitForFences>("vkWaitForFences", 0, device, count, fences, all, timeout);
}
VkResult vkResetFences(VkDevice device, std::uint32_t count, const VkFence* fences) {
  return call<PFN_vkResetFences>("vkResetFences", 0, device, count, fences);
}

}  // extern "C"

namespace relume::test {
namespace {

/// Keeps drivers loaded, which some do not survive to be again and again (NVIDIA's after some thirty times).
class LoadedDrivers {
 public:
  LoadedDrivers() {
    VkInstanceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    if (loader<PFN_vkCreateInstance>("vkCreateInstance")(&info, nullptr, &instance_) != VK_SUCCESS)
      instance_ = VK_NULL_HANDLE;
  }
  ~LoadedDrivers() { loader<PFN_vkDestroyInstance>("vkDestroyInstance")(instance_, nullptr); }
  LoadedDrivers(const LoadedDrivers&) = delete;
  LoadedDrivers& operator=(const LoadedDrivers&) = delete;

 private:
  VkInstance instance_ = VK_NULL_HANDLE;
};

class OwnDeviceFaults : public testing::Test {
 protected:
  /// From no instance to an answer.
  Result<std::vector<Rgb>> solve() const {
    auto device = StandaloneDevice::create({});
    if (!device) return fail(device.error());
    auto out = solve_on_device(*device, model_, lighting_, {3, 0.0}, {.kernel = RowKernel::row_per_thread});
    if (!out) return fail(out.error());
    return std::move(out->irradiance);
  }

  LoadedDrivers drivers_;
  Model model_ = random_model({.clusters_of_system = {20}, .gather_rows = 12}, 1);
  Lighting lighting_ = random_lighting(model_, 2);
};

TEST_F(OwnDeviceFaults, AreOneErrorAndLeaveNothing) {
  faults = {};
  const auto unharmed = solve();
  if (!unharmed && unharmed.error().code == ErrorCode::no_device) GTEST_SKIP() << unharmed.error().message;
  ASSERT_TRUE(unharmed) << unharmed.error().message;
  ASSERT_EQ(faults.living, 0);
  const std::map<std::string, int> calls = faults.calls;
  EXPECT_GE(calls.size(), 18u);
  for (const auto& [name, count] : calls) {
    for (const int at : {0, count - 1}) {
      for (const VkResult result : {VK_ERROR_DEVICE_LOST, VK_ERROR_OUT_OF_DEVICE_MEMORY}) {
        SCOPED_TRACE(name + ", call " + std::to_string(at) + ", " + std::to_string(result));
        faults = {name, at, result, false, {}, 0};
        const auto answer = solve();
        EXPECT_TRUE(faults.failed);
        ASSERT_FALSE(answer);
        EXPECT_TRUE(
            answer.error().code == ErrorCode::no_device ||
            (result == VK_ERROR_OUT_OF_DEVICE_MEMORY && answer.error().code == ErrorCode::out_of_memory))
            << answer.error().message;
        EXPECT_FALSE(answer.error().message.empty());
        EXPECT_EQ(answer.error().message.find('\n'), std::string::npos) << answer.error().message;
        EXPECT_EQ(faults.living, 0);
      }
    }
  }
  faults = {};
  const auto again = solve();
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, *unharmed);
}

}  // namespace
}  // namespace relume::test
