// SPDX-License-Identifier: MIT
#include "compute/device_functions.h"

#include <string>

namespace relume {
namespace {

/// Looks up entry points of one device and remembers the first that is missing.
class Loader {
 public:
  explicit Loader(const HostDevice& host)
      : instance_(host.instance), device_(host.device), get_of_instance_(host.get_instance_proc_addr) {
    if (host.get_instance_proc_addr == nullptr) return;
    get_ = reinterpret_cast<PFN_vkGetDeviceProcAddr>(
        host.get_instance_proc_addr(host.instance, "vkGetDeviceProcAddr"));
  }

  template <class Function>
  void required(Function& function, const char* name) {
    function = get_ == nullptr ? nullptr : reinterpret_cast<Function>(get_(device_, name));
    if (function == nullptr && missing_.empty()) missing_ = name;
  }

  /// Of an instance extension. Devices of some drivers and layers know it whether the host enabled it or not;
  /// the instance does not.
  template <class Function>
  void extension(Function& function, const char* name) const {
    const bool enabled = get_ != nullptr && get_of_instance_(instance_, name) != nullptr;
    function = enabled ? reinterpret_cast<Function>(get_(device_, name)) : nullptr;
  }

  const std::string& missing() const { return missing_; }

 private:
  VkInstance instance_;
  VkDevice device_;
  PFN_vkGetInstanceProcAddr get_of_instance_;
  PFN_vkGetDeviceProcAddr get_ = nullptr;
  std::string missing_;
};

void load_creation(Loader& load, DeviceFunctions& table) {
  load.required(table.create_shader_module, "vkCreateShaderModule");
  load.required(table.destroy_shader_module, "vkDestroyShaderModule");
  load.required(table.create_descriptor_set_layout, "vkCreateDescriptorSetLayout");
  load.required(table.destroy_descriptor_set_layout, "vkDestroyDescriptorSetLayout");
  load.required(table.create_pipeline_layout, "vkCreatePipelineLayout");
  load.required(table.destroy_pipeline_layout, "vkDestroyPipelineLayout");
  load.required(table.create_compute_pipelines, "vkCreateComputePipelines");
  load.required(table.destroy_pipeline, "vkDestroyPipeline");
  load.required(table.create_buffer_view, "vkCreateBufferView");
  load.required(table.destroy_buffer_view, "vkDestroyBufferView");
  load.required(table.create_descriptor_pool, "vkCreateDescriptorPool");
  load.required(table.destroy_descriptor_pool, "vkDestroyDescriptorPool");
  load.required(table.allocate_descriptor_sets, "vkAllocateDescriptorSets");
  load.required(table.update_descriptor_sets, "vkUpdateDescriptorSets");
}

void load_commands(Loader& load, DeviceFunctions& table) {
  load.required(table.cmd_bind_pipeline, "vkCmdBindPipeline");
  load.required(table.cmd_bind_descriptor_sets, "vkCmdBindDescriptorSets");
  load.required(table.cmd_push_constants, "vkCmdPushConstants");
  load.required(table.cmd_dispatch, "vkCmdDispatch");
  load.required(table.cmd_pipeline_barrier, "vkCmdPipelineBarrier");
  load.required(table.cmd_copy_buffer, "vkCmdCopyBuffer");
  load.required(table.cmd_update_buffer, "vkCmdUpdateBuffer");
  load.required(table.cmd_fill_buffer, "vkCmdFillBuffer");
  load.extension(table.cmd_begin_label, "vkCmdBeginDebugUtilsLabelEXT");
  load.extension(table.cmd_end_label, "vkCmdEndDebugUtilsLabelEXT");
}

}  // namespace

Result<DeviceFunctions> load_device_functions(const HostDevice& host) {
  DeviceFunctions table;
  Loader load(host);
  load_creation(load, table);
  load_commands(load, table);
  if (!load.missing().empty()) {
    return fail(ErrorCode::no_device,
                "the host's vkGetInstanceProcAddr and vkGetDeviceProcAddr do not give " + load.missing() +
                    ", which every Vulkan device has");
  }
  return table;
}

}  // namespace relume
