// SPDX-License-Identifier: MIT
#include "compute/recording.h"

#include "compute/vulkan_info.h"

namespace relume {

void record_barrier(const DeviceFunctions& functions, VkCommandBuffer commands, const StageAccess& before,
                    const StageAccess& after) {
  auto barrier = vulkan_info<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  barrier.srcAccessMask = before.access;
  barrier.dstAccessMask = after.access;
  functions.cmd_pipeline_barrier(commands, before.stage, after.stage, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

ScopedLabel::ScopedLabel(const DeviceFunctions& functions, VkCommandBuffer commands, const char* name)
    : functions_(functions), commands_(commands) {
  if (functions_.cmd_begin_label == nullptr || functions_.cmd_end_label == nullptr) return;
  auto label = vulkan_info<VkDebugUtilsLabelEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT);
  label.pLabelName = name;
  functions_.cmd_begin_label(commands_, &label);
}

ScopedLabel::~ScopedLabel() {
  if (functions_.cmd_begin_label == nullptr || functions_.cmd_end_label == nullptr) return;
  functions_.cmd_end_label(commands_);
}

}  // namespace relume
