// SPDX-License-Identifier: MIT
#include "compute/row_kernels.h"

#include <utility>

#include "compute/vulkan_info.h"
#include "kernels/shared/limits.h"

namespace relume {
namespace {

constexpr std::pair<RowKernel, std::string_view> kNames[] = {
    {RowKernel::row_per_thread, "row_per_thread"},
    {RowKernel::row_per_8_lanes, "row_per_8_lanes"},
    {RowKernel::tile_shared, "tile_shared"},
    {RowKernel::tile_shuffle, "tile_shuffle"},
};

/// Where subgroups are wider, lanes meet sooner in shared memory.
constexpr std::uint32_t kWidestForShuffles = 16;

/// Width of subgroups that shuffle in compute; 0: none do.
std::uint32_t shuffle_width(const HostDevice& host) {
  const auto get_properties = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties2>(
      host.get_instance_proc_addr(host.instance, "vkGetPhysicalDeviceProperties2"));
  if (get_properties == nullptr) return 0;
  auto subgroups =
      vulkan_info<VkPhysicalDeviceSubgroupProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES);
  auto properties = vulkan_info<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  properties.pNext = &subgroups;
  get_properties(host.physical_device, &properties);
  const bool shuffles = (subgroups.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0 &&
                        (subgroups.supportedOperations & VK_SUBGROUP_FEATURE_SHUFFLE_BIT) != 0;
  return shuffles ? subgroups.subgroupSize : 0;
}

}  // namespace

std::string_view row_kernel_name(RowKernel kernel) {
  for (const auto& [value, name] : kNames) {
    if (value == kernel) return name;
  }
  return {};
}

std::optional<RowKernel> row_kernel_from_name(std::string_view name) {
  for (const auto& [value, known] : kNames) {
    if (known == name) return value;
  }
  return std::nullopt;
}

bool supports_row_kernel(const HostDevice& host, RowKernel kernel) {
  return kernel != RowKernel::tile_shuffle || shuffle_width(host) >= kernels::kLanes;
}

RowKernel default_tile_kernel(const HostDevice& host) {
  const std::uint32_t width = shuffle_width(host);
  return width >= kernels::kLanes && width <= kWidestForShuffles ? RowKernel::tile_shuffle
                                                                 : RowKernel::tile_shared;
}

}  // namespace relume
