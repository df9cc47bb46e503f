// SPDX-License-Identifier: MIT
#include "compute/pipelines.h"

#include <string>
#include <vector>

#include "compute/kernel_code.h"
#include "compute/vulkan_error.h"
#include "compute/vulkan_info.h"
#include "kernels/shared/records.h"

namespace relume {
namespace {

static_assert(static_cast<kernels::uint>(ValueCodec::f32) == kernels::kCodecF32);
static_assert(static_cast<kernels::uint>(ValueCodec::unorm16) == kernels::kCodecUnorm16);
static_assert(static_cast<kernels::uint>(ValueCodec::sqrt8) == kernels::kCodecSqrt8);

static_assert(static_cast<kernels::uint>(MatrixFetch::storage) == kernels::kFetchStorage);
static_assert(static_cast<kernels::uint>(MatrixFetch::texels) == kernels::kFetchTexels);

/// Storage buffers come first in a set, then texel buffers.
struct SetShape {
  std::uint32_t storage_buffers = 0;
  std::uint32_t texel_buffers = 0;
};

constexpr std::array<SetShape, kernels::kSets> kSetShapes = [] {
  std::array<SetShape, kernels::kSets> shapes{};
  shapes[kernels::kSolveSet] = {kernels::kSolveBindings, 0};
  shapes[kernels::kSystemSet] = {kernels::kSystemBindings, kernels::kSystemTexelBindings};
  shapes[kernels::kBlockSet] = {kernels::kBlockBindings, kernels::kBlockTexelBindings};
  return shapes;
}();

Result<VulkanHandle<VkDescriptorSetLayout>> make_set_layout(const HostDevice& host,
                                                            const DeviceFunctions& functions,
                                                            const SetShape& shape) {
  std::vector<VkDescriptorSetLayoutBinding> bindings(shape.storage_buffers + shape.texel_buffers);
  for (std::uint32_t i = 0; i < bindings.size(); ++i) {
    const VkDescriptorType type = i < shape.storage_buffers ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                                            : VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    bindings[i] = {i, type, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  }
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

Result<VulkanHandle<VkPipelineLayout>> make_pipeline_layout(
    const HostDevice& host, const DeviceFunctions& functions,
    const std::array<VulkanHandle<VkDescriptorSetLayout>, kernels::kSets>& set_layouts) {
  std::array<VkDescriptorSetLayout, kernels::kSets> sets{};
  for (std::size_t i = 0; i < sets.size(); ++i) sets[i] = set_layouts[i].get();
  const VkPushConstantRange constants{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(kernels::Range)};
  auto info = vulkan_info<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  info.setLayoutCount = kernels::kSets;
  info.pSetLayouts = sets.data();
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &constants;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  const VkResult result =
      functions.create_pipeline_layout(host.device, &info, host.allocation_callbacks, &layout);
  if (result != VK_SUCCESS) return tl::unexpected<Error>(vulkan_error(result, "creating a pipeline layout"));
  return VulkanHandle<VkPipelineLayout>(host.device, layout, functions.destroy_pipeline_layout,
                                        host.allocation_callbacks);
}

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

KernelId step_kernel_id(StepKernel step, RowKernel row_kernel) {
  const bool per_thread = row_kernel == RowKernel::row_per_thread;
  switch (step) {
    case StepKernel::bounce:
      return per_thread ? KernelId::bounce_row_per_thread : KernelId::bounce_row_per_8_lanes;
    case StepKernel::gather:
      return per_thread ? KernelId::gather_row_per_thread : KernelId::gather_row_per_8_lanes;
    case StepKernel::import_radiosity:
      break;
  }
  return KernelId::import_radiosity;
}

Result<Pipelines> Pipelines::create(const HostDevice& host, const DeviceFunctions& functions,
                                    MatrixFetch fetch) {
  Pipelines pipelines(host, functions, fetch);
  for (std::uint32_t set = 0; set < kernels::kSets; ++set) {
    auto layout = make_set_layout(host, functions, kSetShapes[set]);
    if (!layout) return tl::unexpected<Error>(layout.error());
    pipelines.set_layouts_[set] = std::move(*layout);
  }
  auto layout = make_pipeline_layout(host, functions, pipelines.set_layouts_);
  if (!layout) return tl::unexpected<Error>(layout.error());
  pipelines.layout_ = std::move(*layout);
  return pipelines;
}

Result<void> Pipelines::add(KernelId kernel, const BlockFormat& format) {
  if (pipelines_.contains({kernel, format})) return {};
  auto module = make_shader_module(host_, functions_, kernel);
  if (!module) return tl::unexpected<Error>(module.error());

  const std::array<std::uint32_t, 3> values = {static_cast<std::uint32_t>(format.codec),
                                               static_cast<std::uint32_t>(fetch_), format.tile_rows};
  const std::array<VkSpecializationMapEntry, 3> entries = {{
      {kernels::kCodecConstant, 0, sizeof values[0]},
      {kernels::kFetchConstant, sizeof values[0], sizeof values[1]},
      {kernels::kTileRowsConstant, 2 * sizeof values[0], sizeof values[2]},
  }};
  const VkSpecializationInfo constants{entries.size(), entries.data(), sizeof values, values.data()};
  auto info = vulkan_info<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module->get();
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &constants;
  info.layout = layout_.get();

  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result = functions_.create_compute_pipelines(host_.device, host_.pipeline_cache, 1, &info,
                                                              host_.allocation_callbacks, &pipeline);
  if (result != VK_SUCCESS) {
    return tl::unexpected<Error>(
        vulkan_error(result, std::string("creating the pipeline of kernel ") + kernel_file_name(kernel)));
  }
  pipelines_.emplace(std::pair{kernel, format},
                     VulkanHandle<VkPipeline>(host_.device, pipeline, functions_.destroy_pipeline,
                                              host_.allocation_callbacks));
  return {};
}

}  // namespace relume
