// SPDX-License-Identifier: MIT
//
// The Vulkan entry points that relume::compute calls, found through the host's own vkGetInstanceProcAddr: the
// library is not linked to a loader and keeps nothing global.
#pragma once

#include <vulkan/vulkan_core.h>

#include "compute/host_device.h"
#include "core/result.h"

namespace relume {

struct DeviceFunctions {
  PFN_vkCreateShaderModule create_shader_module = nullptr;
  PFN_vkDestroyShaderModule destroy_shader_module = nullptr;
  PFN_vkCreateDescriptorSetLayout create_descriptor_set_layout = nullptr;
  PFN_vkDestroyDescriptorSetLayout destroy_descriptor_set_layout = nullptr;
  PFN_vkCreatePipelineLayout create_pipeline_layout = nullptr;
  PFN_vkDestroyPipelineLayout destroy_pipeline_layout = nullptr;
  PFN_vkCreateComputePipelines create_compute_pipelines = nullptr;
  PFN_vkDestroyPipeline destroy_pipeline = nullptr;
  PFN_vkCreateBufferView create_buffer_view = nullptr;
  PFN_vkDestroyBufferView destroy_buffer_view = nullptr;
  PFN_vkCreateDescriptorPool create_descriptor_pool = nullptr;
  PFN_vkDestroyDescriptorPool destroy_descriptor_pool = nullptr;
  PFN_vkAllocateDescriptorSets allocate_descriptor_sets = nullptr;
  PFN_vkUpdateDescriptorSets update_descriptor_sets = nullptr;
  PFN_vkCmdBindPipeline cmd_bind_pipeline = nullptr;
  PFN_vkCmdBindDescriptorSets cmd_bind_descriptor_sets = nullptr;
  PFN_vkCmdPushConstants cmd_push_constants = nullptr;
  PFN_vkCmdDispatch cmd_dispatch = nullptr;
  PFN_vkCmdPipelineBarrier cmd_pipeline_barrier = nullptr;
  PFN_vkCmdCopyBuffer cmd_copy_buffer = nullptr;
  PFN_vkCmdUpdateBuffer cmd_update_buffer = nullptr;
  PFN_vkCmdFillBuffer cmd_fill_buffer = nullptr;
  PFN_vkCmdBeginDebugUtilsLabelEXT cmd_begin_label =
      nullptr;  ///< null unless the host enabled VK_EXT_debug_utils
  PFN_vkCmdEndDebugUtilsLabelEXT cmd_end_label = nullptr;  ///< likewise
};

/// Fails with no_device and the name of the entry point that is missing.
Result<DeviceFunctions> load_device_functions(const HostDevice& host);

}  // namespace relume
