// SPDX-License-Identifier: MIT
#include "compute/pipeline_objects.h"

#include <array>
#include <string>
#include <vector>

#include "compute/vulkan_error.h"
#include "compute/vulkan_info.h"

namespace relume {
namespace {

Result<VulkanHandle<VkShaderModule>> make_shader_module(const HostDevice& host,
                                                        const DeviceFunctions& functions, KernelId kernel) {
  const std::span<const std::uint32_t> code = kernel_code(kernel);
  auto info = vulkan_info<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  info.codeSize = code.size_bytes();
  info.pCode = code.data();
  VkShaderModule module = VK_NULL_HANDLE;
  const VkResult result =
      functions.create_shader_module(host.device, &info, host.allocation_callbacks, &module);
  if (result != VK_SUCCESS) {
    return tl::unexpected<Error>(vulkan_error(
        result, std::string("creating the shader module of kernel ") + kernel_file_name(kernel)));
  }
  return VulkanHandle<VkShaderModule>(host.device, module, functions.destroy_shader_module,
                                      host.allocation_callbacks);
}

}  // namespace

Result<VulkanHandle<VkDescriptorSetLayout>> make_set_layout(const HostDevice& host,
                                                            const DeviceFunctions& functions,
                                                            const SetShape& shape) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  const auto add = [&bindings](VkDescriptorType type, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto binding = static_cast<std::uint32_t>(bindings.size());
      bindings.push_back({binding, type, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    }
  };
  add(VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, shape.storage_buffers);
  add(VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, shape.texel_buffers);
  add(VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, shape.storage_images);
  add(VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, shape.sampled_images);
  auto info =
      vulkan_info<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  info.bindingCount = static_cast<std::uint32_t>(bindings.size());
  info.pBindings = bindings.data();
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  const VkResult result =
      functions.create_descriptor_set_layout(host.device, &info, host.allocation_callbacks, &layout);
  if (result != VK_SUCCESS) {
    return tl::unexpected<Error>(vulkan_error(result, "creating a descriptor set layout"));
  }
  return VulkanHandle<VkDescriptorSetLayout>(host.device, layout, functions.destroy_descriptor_set_layout,
                                             host.allocation_callbacks);
}

Result<VulkanHandle<VkPipelineLayout>> make_pipeline_layout(const HostDevice& host,
                                                            const DeviceFunctions& functions,
                                                            std::span<const VkDescriptorSetLayout> sets,
                                                            std::uint32_t push_constant_bytes) {
  const VkPushConstantRange constants{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_constant_bytes};
  auto info = vulkan_info<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  info.setLayoutCount = static_cast<std::uint32_t>(sets.size());
  info.pSetLayouts = sets.data();
  info.pushConstantRangeCount = push_constant_bytes > 0 ? 1 : 0;
  info.pPushConstantRanges = &constants;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  const VkResult result =
      functions.create_pipeline_layout(host.device, &info, host.allocation_callbacks, &layout);
  if (result != VK_SUCCESS) return tl::unexpected<Error>(vulkan_error(result, "creating a pipeline layout"));
  return VulkanHandle<VkPipelineLayout>(host.device, layout, functions.destroy_pipeline_layout,
                                        host.allocation_callbacks);
}

Result<VulkanHandle<VkPipeline>> make_compute_pipeline(const HostDevice& host,
                                                       const DeviceFunctions& functions,
                                                       VkPipelineLayout layout, KernelId kernel,
                                                       std::span<const std::uint32_t> constants) {
  auto module = make_shader_module(host, functions, kernel);
  if (!module) return tl::unexpected<Error>(module.error());
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) {
    entries.push_back({i, static_cast<std::uint32_t>(i * sizeof constants[0]), sizeof constants[0]});
  }
  const VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            constants.size_bytes(), constants.data()};
  auto info = vulkan_info<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module->get();
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialization;
  info.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result = functions.create_compute_pipelines(host.device, host.pipeline_cache, 1, &info,
                                                             host.allocation_callbacks, &pipeline);
  if (result != VK_SUCCESS) {
    return tl::unexpected<Error>(
        vulkan_error(result, std::string("creating the pipeline of kernel ") + kernel_file_name(kernel)));
  }
  return VulkanHandle<VkPipeline>(host.device, pipeline, functions.destroy_pipeline,
                                  host.allocation_callbacks);
}

Result<VulkanHandle<VkDescriptorPool>> make_descriptor_pool(const HostDevice& host,
                                                            const DeviceFunctions& functions,
                                                            std::uint32_t sets, const SetShape& bindings) {
  std::vector<VkDescriptorPoolSize> sizes;
  const auto add = [&sizes](VkDescriptorType type, std::uint32_t count) {
    if (count > 0) sizes.push_back({type, count});
  };
  add(VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, bindings.storage_buffers);
  add(VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, bindings.texel_buffers);
  add(VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, bindings.storage_images);
  add(VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, bindings.sampled_images);
  auto info = vulkan_info<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  info.maxSets = sets;
  info.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
  info.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  const VkResult result =
      functions.create_descriptor_pool(host.device, &info, host.allocation_callbacks, &pool);
  if (result != VK_SUCCESS) return tl::unexpected<Error>(vulkan_error(result, "creating a descriptor pool"));
  return VulkanHandle<VkDescriptorPool>(host.device, pool, functions.destroy_descriptor_pool,
                                        host.allocation_callbacks);
}

Result<VulkanHandle<VkBufferView>> make_texel_view(const HostDevice& host, const DeviceFunctions& functions,
                                                   const BufferRange& range, VkFormat format) {
  auto info = vulkan_info<VkBufferViewCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO);
  info.buffer = range.buffer;
  info.format = format;
  info.offset = range.offset;
  info.range = range.byte_size;
  VkBufferView view = VK_NULL_HANDLE;
  const VkResult result = functions.create_buffer_view(host.device, &info, host.allocation_callbacks, &view);
  if (result != VK_SUCCESS) return tl::unexpected<Error>(vulkan_error(result, "creating a buffer view"));
  return VulkanHandle<VkBufferView>(host.device, view, functions.destroy_buffer_view,
                                    host.allocation_callbacks);
}

}  // namespace relume
