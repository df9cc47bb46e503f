// SPDX-License-Identifier: MIT
//
// Small helpers of the functions that record.
#pragma once

#include "compute/device_functions.h"

namespace relume {

/// A stage and what it does to memory.
struct StageAccess {
  VkPipelineStageFlags stage = 0;
  VkAccessFlags access = 0;
};

/// Compute shaders and transfers, reads and writes.
inline constexpr StageAccess kComputeAndTransfer{
    VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
    VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT |
        VK_ACCESS_TRANSFER_WRITE_BIT};

/// What `before` did is done and visible before `after` starts.
void record_barrier(const DeviceFunctions& functions, VkCommandBuffer commands, const StageAccess& before,
                    const StageAccess& after);

/// Labels what is recorded while it lives, for debuggers; nothing when the host has not enabled
/// VK_EXT_debug_utils.
class ScopedLabel {
 public:
  ScopedLabel(const DeviceFunctions& functions, VkCommandBuffer commands, const char* name);
  ScopedLabel(const ScopedLabel&) = delete;
  ScopedLabel& operator=(const ScopedLabel&) = delete;
  ~ScopedLabel();

 private:
  const DeviceFunctions& functions_;
  VkCommandBuffer commands_;
};

}  // namespace relume
