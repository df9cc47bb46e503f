// SPDX-License-Identifier: MIT
#include "compute/device_requirements.h"

#include <string>

#include "core/block_matrix.h"
#include "kernels/shared/bindings.h"
#include "kernels/shared/limits.h"
#include "kernels/shared/records.h"

namespace relume {
namespace {

constexpr std::uint32_t kStorageBuffers =
    kernels::kSolveBindings + kernels::kSystemBindings + kernels::kBlockBindings;
constexpr std::uint32_t kTexelBuffers =
    kernels::kSolveTexelBindings + kernels::kSystemTexelBindings + kernels::kBlockTexelBindings;

struct LimitCheck {
  const char* name;
  std::uint64_t found;
  std::uint64_t needed;
};

std::string missing(const VkPhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_1) return "Vulkan 1.1";
  const VkPhysicalDeviceLimits& limits = properties.limits;
  const LimitCheck checks[] = {
      {"maxPerStageDescriptorStorageBuffers", limits.maxPerStageDescriptorStorageBuffers, kStorageBuffers},
      {"maxDescriptorSetStorageBuffers", limits.maxDescriptorSetStorageBuffers, kStorageBuffers},
      {"maxPerStageDescriptorSampledImages", limits.maxPerStageDescriptorSampledImages, kTexelBuffers},
      {"maxTexelBufferElements", limits.maxTexelBufferElements, kMaxImports},
      {"maxBoundDescriptorSets", limits.maxBoundDescriptorSets, kernels::kSets},
      {"maxComputeWorkGroupInvocations", limits.maxComputeWorkGroupInvocations, kernels::kWorkgroupSize},
      {"maxComputeWorkGroupSize[0]", limits.maxComputeWorkGroupSize[0], kernels::kWorkgroupSize},
      {"maxComputeWorkGroupCount[0]", limits.maxComputeWorkGroupCount[0], kernels::kMaxWorkgroups},
      {"maxPushConstantsSize", limits.maxPushConstantsSize, sizeof(kernels::Range)},
  };
  for (const LimitCheck& check : checks) {
    if (check.found < check.needed) {
      return std::string(check.name) + " of at least " + std::to_string(check.needed) + " (it offers " +
             std::to_string(check.found) + ")";
    }
  }
  return {};
}

bool has_compute_queue(PFN_vkGetPhysicalDeviceQueueFamilyProperties get_families, VkPhysicalDevice device) {
  std::uint32_t count = 0;
  get_families(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  get_families(device, &count, families.data());
  for (const VkQueueFamilyProperties& family : families) {
    if ((family.queueFlags & VK_QUEUE_COMPUTE_BIT) != 0) return true;
  }
  return false;
}

}  // namespace

Result<DeviceRequirements> device_requirements(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                               VkInstance instance, VkPhysicalDevice physical_device) {
  const auto get_properties = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(
      get_instance_proc_addr(instance, "vkGetPhysicalDeviceProperties"));
  const auto get_families = reinterpret_cast<PFN_vkGetPhysicalDeviceQueueFamilyProperties>(
      get_instance_proc_addr(instance, "vkGetPhysicalDeviceQueueFamilyProperties"));
  if (get_properties == nullptr || get_families == nullptr) {
    return fail(ErrorCode::no_device,
                "the host's vkGetInstanceProcAddr does not give vkGetPhysicalDeviceProperties");
  }
  VkPhysicalDeviceProperties properties{};
  get_properties(physical_device, &properties);
  std::string lacks = missing(properties);
  if (lacks.empty() && !has_compute_queue(get_families, physical_device)) lacks = "a compute queue";
  if (!lacks.empty()) {
    return fail(ErrorCode::no_device,
                "the device '" + std::string(properties.deviceName) + "' lacks " + lacks);
  }
  return DeviceRequirements{};
}

}  // namespace relume
