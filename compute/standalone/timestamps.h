// SPDX-License-Identifier: MIT
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <vector>

#include "compute/vulkan_handle.h"
#include "core/result.h"

namespace relume {

/// Moments of a device's clock between the commands of a command buffer.
class Timestamps {
 public:
  /// `count` moments, for queues of this family. Where those have no clock, nothing is recorded and all times
  /// are 0.
  static Result<Timestamps> create(VkPhysicalDevice physical_device, VkDevice device,
                                   std::uint32_t queue_family, std::uint32_t count);

  /// Before the first mark() of a command buffer.
  void record_reset(VkCommandBuffer commands) const;

  /// Moment number `moment`: when all that was recorded before has run.
  void record_mark(VkCommandBuffer commands, std::uint32_t moment) const;

  /// Seconds from each moment to the next, one less than moments, 0 when the queue has no timestamps; once
  /// the command buffer has run. Fails as the device does.
  Result<std::vector<double>> seconds() const;

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  VulkanHandle<VkQueryPool> pool_;  ///< null: no clock
  std::uint32_t count_ = 0;
  std::uint64_t mask_ = 0;
  double seconds_per_tick_ = 0.0;
};

}  // namespace relume
