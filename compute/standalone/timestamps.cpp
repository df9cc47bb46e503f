// SPDX-License-Identifier: MIT
#include "compute/standalone/timestamps.h"

#include <vulkan/vulkan.h>

#include "compute/vulkan_error.h"
#include "compute/vulkan_info.h"

namespace relume {
namespace {

/// The bits of a timestamp that count; 0: the queues have no clock.
std::uint64_t timestamp_mask(VkPhysicalDevice device, std::uint32_t family) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  const std::uint32_t bits = family < count ? families[family].timestampValidBits : 0;
  return bits == 0 ? 0 : ~std::uint64_t{0} >> (64 - bits);
}

}  // namespace

Result<Timestamps> Timestamps::create(VkPhysicalDevice physical_device, VkDevice device,
                                      std::uint32_t queue_family, std::uint32_t count) {
  Timestamps made;
  made.device_ = device;
  made.count_ = count;
  made.mask_ = timestamp_mask(physical_device, queue_family);
  if (made.mask_ == 0) return made;
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(physical_device, &properties);
  made.seconds_per_tick_ = 1e-9 * double{properties.limits.timestampPeriod};
  auto info = vulkan_info<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = count;
  VkQueryPool pool = VK_NULL_HANDLE;
  const auto created =
      check_vulkan(vkCreateQueryPool(device, &info, nullptr, &pool), "creating a query pool");
  if (!created) return tl::unexpected<Error>(created.error());
  made.pool_ = {device, pool, vkDestroyQueryPool, nullptr};
  return made;
}

void Timestamps::record_reset(VkCommandBuffer commands) const {
  if (mask_ != 0) vkCmdResetQueryPool(commands, pool_.get(), 0, count_);
}

void Timestamps::record_mark(VkCommandBuffer commands, std::uint32_t moment) const {
  if (mask_ != 0) vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, pool_.get(), moment);
}

Result<std::vector<double>> Timestamps::seconds() const {
  std::vector<double> between(count_ - 1, 0.0);
  if (mask_ == 0) return between;
  std::vector<std::uint64_t> ticks(count_);
  const VkResult read = vkGetQueryPoolResults(device_, pool_.get(), 0, count_, count_ * sizeof ticks[0],
                                              ticks.data(), sizeof ticks[0], VK_QUERY_RESULT_64_BIT);
  if (auto done = check_vulkan(read, "reading timestamps"); !done) return tl::unexpected<Error>(done.error());
  for (std::uint32_t i = 0; i + 1 < count_; ++i)
    between[i] = static_cast<double>((ticks[i + 1] - ticks[i]) & mask_) * seconds_per_tick_;
  return between;
}

}  // namespace relume
