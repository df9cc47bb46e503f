// SPDX-License-Identifier: MIT
#include "compute/descriptor_sets.h"

#include <algorithm>
#include <array>
#include <utility>

#include "compute/pipeline_objects.h"
#include "compute/vulkan_error.h"
#include "compute/vulkan_info.h"

namespace relume {
namespace {

/// A texel buffer that shows the same bytes as a storage buffer of its set.
struct TexelPlan {
  std::uint32_t binding = 0;
  std::uint32_t storage_binding = 0;
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkDeviceSize texel_bytes = 0;
  VkBufferView view = VK_NULL_HANDLE;
};

/// Of a quantity per element: kRgbBytes.
constexpr VkFormat kRgbFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

/// What one descriptor set binds, and where the set goes.
struct SetPlan {
  std::uint32_t layout = 0;
  VkDescriptorSet* set = nullptr;
  std::vector<VkDescriptorBufferInfo> bindings;  ///< storage buffers, by binding number
  std::vector<TexelPlan> texels;
};

VkDescriptorBufferInfo part(const BufferRange& range, VkDeviceSize offset, VkDeviceSize byte_size) {
  return {range.buffer, range.offset + offset, byte_size};
}

VkDescriptorBufferInfo whole(const BufferRange& range) {
  return part(range, 0, range.byte_size);
}

SetPlan plan_solve_set(std::span<const BufferRange> ranges, VkDescriptorSet& set) {
  SetPlan plan{kernels::kSolveSet, &set, {}, {}};
  for (std::uint32_t i = 0; i < kernels::kSolveBindings; ++i) plan.bindings.push_back(whole(ranges[i]));
  plan.texels = {{kernels::kRadiosityTexelsBinding, kernels::kRadiosityBinding, kRgbFormat, kRgbBytes},
                 {kernels::kFirstSenderTexelsBinding, kernels::kFirstSenderBinding, VK_FORMAT_R32_UINT, 4}};
  return plan;
}

/// What the kernels of nodes read.
constexpr std::array<TexelPlan, 3> kNodeTexels{
    {{kernels::kNodeTexelsBinding, kernels::kNodesBinding, VK_FORMAT_R32G32B32A32_UINT, kRgbBytes},
     {kernels::kNodePartTexelsBinding, kernels::kNodePartsBinding, VK_FORMAT_R32G32_UINT, 8},
     {kernels::kOwnRadiosityTexelsBinding, kernels::kOwnRadiosityBinding, kRgbFormat, kRgbBytes}}};

/// For the kernels of nodes; something must stand in the places of what they do not use.
SetPlan plan_sky_set(std::span<const BufferRange> ranges, const BufferRange& radiosity,
                     VkDescriptorSet& set) {
  SetPlan plan{kernels::kSystemSet,
               &set,
               std::vector<VkDescriptorBufferInfo>(kernels::kSystemBindings, whole(ranges[kSkyNodes])),
               {}};
  plan.bindings[kernels::kNodePartsBinding] = whole(ranges[kSkyParts]);
  plan.bindings[kernels::kOwnRadiosityBinding] = whole(radiosity);
  plan.texels.assign(kNodeTexels.begin(), kNodeTexels.end());
  return plan;
}

SetPlan plan_system_set(std::span<const BufferRange> ranges, const BufferRange& radiosity, bool half_senders,
                        VkDescriptorSet& set) {
  SetPlan plan{kernels::kSystemSet, &set, {}, {}};
  for (std::uint32_t i = 0; i < kSystemBuffers; ++i) plan.bindings.push_back(whole(ranges[i]));
  plan.bindings.push_back(whole(radiosity));
  plan.texels = {
      {kernels::kImportTexelsBinding, kernels::kImportsBinding, VK_FORMAT_R32G32B32A32_UINT, kRgbBytes},
      {kernels::kLocalRadiosityTexelsBinding, kernels::kLocalRadiosityBinding,
       half_senders ? VK_FORMAT_R16G16B16A16_SFLOAT : kRgbFormat, half_senders ? kHalfRgbBytes : kRgbBytes},
      {kernels::kAlbedoTexelsBinding, kernels::kAlbedoBinding, kRgbFormat, kRgbBytes},
      {kernels::kExitanceTexelsBinding, kernels::kExitanceBinding, kRgbFormat, kRgbBytes},
      {kernels::kDirectTexelsBinding, kernels::kDirectBinding, kRgbFormat, kRgbBytes}};
  plan.texels.insert(plan.texels.end(), kNodeTexels.begin(), kNodeTexels.end());
  return plan;
}

VkDeviceSize texel_bytes(VkFormat code_format) {
  if (code_format == VK_FORMAT_R32G32B32A32_UINT) return 16;
  return code_format == VK_FORMAT_R32G32_UINT ? 8 : 4;
}

void plan_block_sets(const std::vector<BlockLayout>& blocks, std::span<const BufferRange> ranges,
                     std::vector<VkDescriptorSet>& sets, std::vector<SetPlan>& plans) {
  sets.resize(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    SetPlan plan{kernels::kBlockSet, &sets[i], {}, {}};
    for (const BlockSection& section : blocks[i].sections) {
      plan.bindings.push_back(part(ranges[blocks[i].buffer], section.offset, section.byte_size));
    }
    plan.texels = {{kernels::kColumnTexelsBinding, kernels::kColumnsBinding, VK_FORMAT_R32_UINT, 4},
                   {kernels::kValueTexelsBinding, kernels::kValuesBinding, VK_FORMAT_R32_UINT, 4},
                   {kernels::kCodeTexelsBinding, kernels::kValuesBinding, blocks[i].code_format,
                    texel_bytes(blocks[i].code_format)},
                   {kernels::kTileOffsetTexelsBinding, kernels::kTileOffsetsBinding, VK_FORMAT_R32_UINT, 4},
                   {kernels::kRowScaleTexelsBinding, kernels::kRowScalesBinding, VK_FORMAT_R32_SFLOAT, 4}};
    plans.push_back(std::move(plan));
  }
}

void plan_probe_sets(const std::vector<ProbeBlockLayout>& blocks, std::span<const BufferRange> ranges,
                     const BufferRange& coefficients, std::vector<VkDescriptorSet>& sets,
                     std::vector<SetPlan>& plans) {
  sets.resize(blocks.size());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    SetPlan plan{kernels::kBlockSet, &sets[b], {}, {}};
    for (std::uint32_t i = 0; i < kProbeBuffers; ++i)
      plan.bindings.push_back(whole(ranges[blocks[b].first_buffer + i]));
    plan.bindings.push_back(whole(coefficients));
    plans.push_back(std::move(plan));
  }
}

Result<void> make_texel_views(const HostDevice& host, const DeviceFunctions& functions,
                              VkDeviceSize max_texels, std::vector<SetPlan>& plans,
                              std::vector<VulkanHandle<VkBufferView>>& views) {
  for (SetPlan& plan : plans) {
    for (TexelPlan& texels : plan.texels) {
      const VkDescriptorBufferInfo& bytes = plan.bindings[texels.storage_binding];
      auto view = make_texel_view(
          host, functions,
          {bytes.buffer, bytes.offset, std::min(bytes.range, max_texels * texels.texel_bytes)},
          texels.format);
      if (!view) return tl::unexpected<Error>(view.error());
      texels.view = view->get();
      views.push_back(std::move(*view));
    }
  }
  return {};
}

Result<VulkanHandle<VkDescriptorPool>> make_pool(const HostDevice& host, const DeviceFunctions& functions,
                                                 const std::vector<SetPlan>& plans) {
  SetShape bindings;
  for (const SetPlan& plan : plans) {
    bindings.storage_buffers += set_shape(plan.layout).storage_buffers;
    bindings.texel_buffers += set_shape(plan.layout).texel_buffers;
  }
  return make_descriptor_pool(host, functions, static_cast<std::uint32_t>(plans.size()), bindings);
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
    auto buffers = vulkan_info<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
    buffers.dstSet = *plan.set;
    buffers.descriptorCount = static_cast<std::uint32_t>(plan.bindings.size());
    buffers.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    buffers.pBufferInfo = plan.bindings.data();
    writes.push_back(buffers);
    for (const TexelPlan& texels : plan.texels) {
      auto view = vulkan_info<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
      view.dstSet = *plan.set;
      view.dstBinding = texels.binding;
      view.descriptorCount = 1;
      view.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
      view.pTexelBufferView = &texels.view;
      writes.push_back(view);
    }
  }
  functions.update_descriptor_sets(host.device, static_cast<std::uint32_t>(writes.size()), writes.data(), 0,
                                   nullptr);
}

/// Allocates and writes all sets.
Result<VulkanHandle<VkDescriptorPool>> make_sets(const HostDevice& host, const DeviceFunctions& functions,
                                                 const Pipelines& pipelines,
                                                 const std::vector<SetPlan>& plans) {
  auto pool = make_pool(host, functions, plans);
  if (!pool) return pool;
  if (auto allocated = allocate(host, functions, pipelines, pool->get(), plans); !allocated) {
    return tl::unexpected<Error>(allocated.error());
  }
  write(host, functions, plans);
  return pool;
}

}  // namespace

Result<SolveSets> make_solve_sets(const HostDevice& host, const DeviceFunctions& functions,
                                  const Pipelines& pipelines, std::span<const BufferRange> ranges,
                                  const BufferRange& sky_radiosity, VkDeviceSize max_texels) {
  SolveSets sets;
  std::vector<SetPlan> plans = {plan_solve_set(ranges, sets.solve),
                                plan_sky_set(ranges, sky_radiosity, sets.sky)};
  if (auto made = make_texel_views(host, functions, max_texels, plans, sets.texel_views); !made) {
    return tl::unexpected<Error>(made.error());
  }
  auto pool = make_sets(host, functions, pipelines, plans);
  if (!pool) return tl::unexpected<Error>(pool.error());
  sets.pool = std::move(*pool);
  return sets;
}

Result<RoomSets> make_room_sets(const HostDevice& host, const DeviceFunctions& functions,
                                const Pipelines& pipelines, std::vector<BufferRange> ranges,
                                VkDeviceSize max_texels) {
  RoomSets sets;
  SetPlan plan{kernels::kBlockSet, &sets.rooms, {}, {}};
  for (const BufferRange& range : ranges) plan.bindings.push_back(whole(range));
  plan.texels = {{kernels::kRoomEntryTexelsBinding, kernels::kRoomEntriesBinding, VK_FORMAT_R32G32_UINT, 8}};
  std::vector<SetPlan> plans{std::move(plan)};
  if (auto made = make_texel_views(host, functions, max_texels, plans, sets.texel_views); !made) {
    return tl::unexpected<Error>(made.error());
  }
  auto pool = make_sets(host, functions, pipelines, plans);
  if (!pool) return tl::unexpected<Error>(pool.error());
  sets.pool = std::move(*pool);
  sets.ranges = std::move(ranges);
  return sets;
}

Result<SystemSets> make_system_sets(const HostDevice& host, const DeviceFunctions& functions,
                                    const Pipelines& pipelines, const SystemLayout& layout,
                                    std::span<const BufferRange> ranges, const BufferRange& radiosity,
                                    const BufferRange& coefficients, VkDeviceSize max_texels) {
  SystemSets sets;
  std::vector<SetPlan> plans = {plan_system_set(ranges, radiosity, layout.half_senders, sets.system)};
  plan_block_sets(layout.bounce, ranges, sets.bounce, plans);
  plan_block_sets(layout.gather, ranges, sets.gather, plans);
  plan_probe_sets(layout.probes, ranges, coefficients, sets.probes, plans);
  if (auto made = make_texel_views(host, functions, max_texels, plans, sets.texel_views); !made) {
    return tl::unexpected<Error>(made.error());
  }
  auto pool = make_sets(host, functions, pipelines, plans);
  if (!pool) return tl::unexpected<Error>(pool.error());
  sets.pool = std::move(*pool);
  return sets;
}

}  // namespace relume
