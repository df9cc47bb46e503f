// SPDX-License-Identifier: MIT
#include "compute/run_kernel.h"

#include <gtest/gtest.h>

#include "compute/pipeline_objects.h"
#include "compute/vulkan_info.h"

namespace relume::test {
namespace {

VkDescriptorSet make_set(VkDevice owner, VkDescriptorPool pool, VkDescriptorSetLayout layout,
                         const KernelRun& run) {
  auto info = vulkan_info<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  info.descriptorPool = pool;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  EXPECT_EQ(vkAllocateDescriptorSets(owner, &info, &set), VK_SUCCESS);
  std::vector<VkDescriptorBufferInfo> ranges;
  for (const BufferRange& buffer : run.buffers)
    ranges.push_back({buffer.buffer, buffer.offset, buffer.byte_size});
  auto write = vulkan_info<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
  write.dstSet = set;
  write.descriptorCount = std::uint32_t(ranges.size());
  write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  write.pBufferInfo = ranges.data();
  std::vector<VkWriteDescriptorSet> writes{write};
  if (run.sampled) {
    write.dstBinding = std::uint32_t(ranges.size());
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    write.pBufferInfo = nullptr;
    write.pImageInfo = &*run.sampled;
    writes.push_back(write);
  }
  vkUpdateDescriptorSets(owner, std::uint32_t(writes.size()), writes.data(), 0, nullptr);
  return set;
}

VulkanHandle<VkPipeline> make_pipeline(VkDevice owner, VkPipelineLayout layout,
                                       std::span<const std::uint32_t> spirv) {
  auto code = vulkan_info<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  code.codeSize = spirv.size_bytes();
  code.pCode = spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  EXPECT_EQ(vkCreateShaderModule(owner, &code, nullptr, &module), VK_SUCCESS);
  const VulkanHandle<VkShaderModule> module_owner(owner, module, vkDestroyShaderModule, nullptr);
  auto info = vulkan_info<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  EXPECT_EQ(vkCreateComputePipelines(owner, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline), VK_SUCCESS);
  return {owner, pipeline, vkDestroyPipeline, nullptr};
}

}  // namespace

void run_kernel(StandaloneDevice& device, const KernelRun& run) {
  const HostDevice host = device.host();
  const auto functions = load_device_functions(host);
  ASSERT_TRUE(functions);
  const SetShape shape{.storage_buffers = std::uint32_t(run.buffers.size()),
                       .sampled_images = run.sampled ? 1u : 0u};
  const auto set_layout = make_set_layout(host, *functions, shape);
  ASSERT_TRUE(set_layout);
  const VkDescriptorSetLayout set_layout_of = set_layout->get();
  const auto layout = make_pipeline_layout(host, *functions, {&set_layout_of, 1}, 0);
  const auto pool = make_descriptor_pool(host, *functions, 1, shape);
  ASSERT_TRUE(layout && pool);
  const VkDescriptorSet set = make_set(host.device, pool->get(), set_layout_of, run);
  const VulkanHandle<VkPipeline> pipeline = make_pipeline(host.device, layout->get(), run.spirv);
  EXPECT_TRUE(device.submit([&](VkCommandBuffer commands) {
    if (run.record_before) run.record_before(commands);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.get());
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout->get(), 0, 1, &set, 0, nullptr);
    vkCmdDispatch(commands, run.groups, 1, 1);
  }));
}

}  // namespace relume::test
