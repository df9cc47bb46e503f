// SPDX-License-Identifier: MIT
//
// The Vulkan objects that kernels need, made one at a time. The device and callbacks of `host` must outlive
// them. All fail with no_device or out_of_memory.
#pragma once

#include <cstdint>
#include <span>

#include "compute/device_functions.h"
#include "compute/host_device.h"
#include "compute/kernel_code.h"
#include "compute/vulkan_handle.h"
#include "core/result.h"

namespace relume {

/// The bindings of a descriptor set, numbered in this order from 0: storage buffers, then uniform texel
/// buffers, then storage images, then
/// images with their samplers.
struct SetShape {
  std::uint32_t storage_buffers = 0;
  std::uint32_t texel_buffers = 0;
  std::uint32_t storage_images = 0;
  std::uint32_t sampled_images = 0;
};

Result<VulkanHandle<VkDescriptorSetLayout>> make_set_layout(const HostDevice& host,
                                                            const DeviceFunctions& functions,
                                                            const SetShape& shape);

/// `push_constant_bytes`, a multiple of 4 up to 128, start at 0; none when it is 0.
Result<VulkanHandle<VkPipelineLayout>> make_pipeline_layout(const HostDevice& host,
                                                            const DeviceFunctions& functions,
                                                            std::span<const VkDescriptorSetLayout> sets,
                                                            std::uint32_t push_constant_bytes);

/// `constants` are the values of specialization constants 0, 1, ..., 32 bits each.
Result<VulkanHandle<VkPipeline>> make_compute_pipeline(const HostDevice& host,
                                                       const DeviceFunctions& functions,
                                                       VkPipelineLayout layout, KernelId kernel,
                                                       std::span<const std::uint32_t> constants);

/// Room for `sets` sets with so many bindings of each kind in all of them together.
Result<VulkanHandle<VkDescriptorPool>> make_descriptor_pool(const HostDevice& host,
                                                            const DeviceFunctions& functions,
                                                            std::uint32_t sets, const SetShape& bindings);

/// A view of a range as texels of `format`, for a uniform texel buffer.
Result<VulkanHandle<VkBufferView>> make_texel_view(const HostDevice& host, const DeviceFunctions& functions,
                                                   const BufferRange& range, VkFormat format);

}  // namespace relume
