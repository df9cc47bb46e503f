// SPDX-License-Identifier: MIT
#include "compute/descriptor_sets.h"

#include <cstddef>

#include "compute/vulkan_error.h"
#include "compute/vulkan_info.h"

namespace relume {
namespace {

/// What one descriptor set binds, and where the set goes.
struct SetPlan {
  std::uint32_t layout = 0;
  VkDescriptorSet* set = nullptr;
  std::vector<VkDescriptorBufferInfo> bindings;  ///< by binding number
};

VkDescriptorBufferInfo part(const BufferRange& range, VkDeviceSize offset, VkDeviceSize byte_size) {
  return {range.buffer, range.offset + offset, byte_size};
}

VkDescriptorBufferInfo whole(const BufferRange& range) {
  return part(range, 0, range.byte_size);
}

SetPlan plan_solve_set(std::span<const BufferRange> ranges, std::uint32_t half_in, VkDescriptorSet& set) {
  SetPlan plan{kernels::kSolveSet, &set, std::vector<VkDescriptorBufferInfo>(kernels::kSolveBindings)};
  plan.bindings[kernels::kRadiosityInBinding] = whole(ranges[half_in == 0 ? kRadiosityA : kRadiosityB]);
  plan.bindings[kernels::kRadiosityOutBinding] = whole(ranges[half_in == 0 ? kRadiosityB : kRadiosityA]);
  plan.bindings[kernels::kAlbedoBinding] = whole(ranges[kAlbedo]);
  plan.bindings[kernels::kExitanceBinding] = whole(ranges[kExitance]);
  plan.bindings[kernels::kDirectBinding] = whole(ranges[kDirect]);
  plan.bindings[kernels::kWeightsBinding] = whole(ranges[kWeights]);
  plan.bindings[kernels::kResidualBinding] = whole(ranges[kResidual]);
  return plan;
}

SetPlan plan_system_set(const SystemLayout& system, std::span<const BufferRange> ranges,
                        VkDescriptorSet& set) {
  SetPlan plan{kernels::kSystemSet, &set, std::vector<VkDescriptorBufferInfo>(kernels::kSystemBindings)};
  plan.bindings[kernels::kImportsBinding] = whole(ranges[system.imports_buffer]);
  plan.bindings[kernels::kLocalRadiosityBinding] = whole(ranges[system.local_radiosity_buffer]);
  plan.bindings[kernels::kIrradianceBinding] = whole(ranges[system.irradiance_buffer]);
  return plan;
}

void plan_block_sets(const std::vector<BlockLayout>& blocks, std::span<const BufferRange> ranges,
                     std::vector<VkDescriptorSet>& sets, std::vector<SetPlan>& plans) {
  sets.resize(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    SetPlan plan{kernels::kBlockSet, &sets[i], {}};
    for (const Section& section : blocks[i].sections) {
      plan.bindings.push_back(part(ranges[blocks[i].buffer], section.offset, section.byte_size));
    }
    plans.push_back(std::move(plan));
  }
}

/// All sets; the plans point into `sets`, whose vectors do not grow afterwards.
std::vector<SetPlan> plan_sets(const SolverLayout& layout, std::span<const BufferRange> ranges,
                               DescriptorSets& sets) {
  std::vector<SetPlan> plans;
  sets.systems.resize(layout.systems.size());
  for (std::uint32_t half = 0; half < 2; ++half) {
    plans.push_back(plan_solve_set(ranges, half, sets.solve[half]));
  }
  for (std::size_t i = 0; i < layout.systems.size(); ++i) {
    plans.push_back(plan_system_set(layout.systems[i], ranges, sets.systems[i].system));
    plan_block_sets(layout.systems[i].bounce, ranges, sets.systems[i].bounce, plans);
    plan_block_sets(layout.systems[i].gather, ranges, sets.systems[i].gather, plans);
  }
  return plans;
}

Result<VulkanHandle<VkDescriptorPool>> make_pool(const HostDevice& host, const DeviceFunctions& functions,
                                                 const std::vector<SetPlan>& plans) {
  VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 0};
  for (const SetPlan& plan : plans) size.descriptorCount += static_cast<std::uint32_t>(plan.bindings.size());
  auto info = vulkan_info<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  info.maxSets = static_cast<std::uint32_t>(plans.size());
  info.poolSizeCount = 1;
  info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  const VkResult result =
      functions.create_descriptor_pool(host.device, &info, host.allocation_callbacks, &pool);
  if (result != VK_SUCCESS) return tl::unexpected<Error>(vulkan_error(result, "creating a descriptor pool"));
  return VulkanHandle<VkDescriptorPool>(host.device, pool, functions.destroy_descriptor_pool,
                                        host.allocation_callbacks);
}

Result<void> allocate(const HostDevice& host, const DeviceFunctions& functions, const Pipelines& pipelines,
                      VkDescriptorPool pool, const std::vector<SetPlan>& plans) {
  std::vector<VkDescriptorSetLayout> layouts;
  for (const SetPlan& plan : plans) layouts.push_back(pipelines.set_layout(plan.layout));
  auto info = vulkan_info<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  info.descriptorPool = pool;
  info.descriptorSetCount = static_cast<std::uint32_t>(layouts.size());
  info.pSetLayouts = layouts.data();
  std::vector<VkDescriptorSet> sets(plans.size());
  const VkResult result = functions.allocate_descriptor_sets(host.device, &info, sets.data());
  for (std::size_t i = 0; i < plans.size(); ++i) *plans[i].set = sets[i];
  return check_vulkan(result, "allocating descriptor sets");
}

void write(const HostDevice& host, const DeviceFunctions& functions, const std::vector<SetPlan>& plans) {
  std::vector<VkWriteDescriptorSet> writes;
  for (const SetPlan& plan : plans) {
    auto entry = vulkan_info<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
    entry.dstSet = *plan.set;
    entry.descriptorCount = static_cast<std::uint32_t>(plan.bindings.size());
    entry.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    entry.pBufferInfo = plan.bindings.data();
    writes.push_back(entry);
  }
  functions.update_descriptor_sets(host.device, static_cast<std::uint32_t>(writes.size()), writes.data(), 0,
                                   nullptr);
}

}  // namespace

Result<DescriptorSets> make_descriptor_sets(const HostDevice& host, const DeviceFunctions& functions,
                                            const Pipelines& pipelines, const SolverLayout& layout,
                                            std::span<const BufferRange> ranges) {
  DescriptorSets sets;
  const std::vector<SetPlan> plans = plan_sets(layout, ranges, sets);
  auto pool = make_pool(host, functions, plans);
  if (!pool) return tl::unexpected<Error>(pool.error());
  sets.pool = std::move(*pool);
  if (auto allocated = allocate(host, functions, pipelines, sets.pool.get(), plans); !allocated) {
    return tl::unexpected<Error>(allocated.error());
  }
  write(host, functions, plans);
  return sets;
}

}  // namespace relume
