// SPDX-License-Identifier: MIT
//
// The descriptor sets of a solver and of each system, from a pool of their own: written once when buffers are
// bound and never again, so that recording needs no extension and command buffers in flight share them.
#pragma once

#include <span>
#include <vector>

#include "compute/device_functions.h"
#include "compute/host_device.h"
#include "compute/pipelines.h"
#include "compute/solver_layout.h"

namespace relume {

struct SolveSets {
  std::vector<VulkanHandle<VkBufferView>> texel_views;
  VulkanHandle<VkDescriptorPool> pool;
  VkDescriptorSet solve = VK_NULL_HANDLE;
  VkDescriptorSet sky = VK_NULL_HANDLE;  ///< as of a system, for the kernels of nodes alone
};

struct SystemSets {
  std::vector<VulkanHandle<VkBufferView>> texel_views;
  VulkanHandle<VkDescriptorPool> pool;
  VkDescriptorSet system = VK_NULL_HANDLE;
  std::vector<VkDescriptorSet> bounce;  ///< per block
  std::vector<VkDescriptorSet> gather;  ///< per block
  std::vector<VkDescriptorSet> probes;  ///< per block
};

struct RoomSets {
  std::vector<VulkanHandle<VkBufferView>> texel_views;
  std::vector<BufferRange> ranges;  ///< per RoomBuffer
  VulkanHandle<VkDescriptorPool> pool;
  VkDescriptorSet rooms = VK_NULL_HANDLE;  ///< a kBlockSet
};

/// `ranges` has one entry per RoomBuffer.
Result<RoomSets> make_room_sets(const HostDevice& host, const DeviceFunctions& functions,
                                const Pipelines& pipelines, std::vector<BufferRange> ranges,
                                VkDeviceSize max_texels);

/// `ranges` has one entry per buffer of the layout of the whole solve; `sky_radiosity`: of its senders. Texel
/// buffers show no more than `max_texels` elements; a device that has fewer than a buffer holds must use
/// MatrixFetch::storage.
Result<SolveSets> make_solve_sets(const HostDevice& host, const DeviceFunctions& functions,
                                  const Pipelines& pipelines, std::span<const BufferRange> ranges,
                                  const BufferRange& sky_radiosity, VkDeviceSize max_texels);

/// `ranges` has one entry per buffer of the system; `radiosity`: of both of its halves; `coefficients`: of
/// the probes of all; `max_texels`: as above.
Result<SystemSets> make_system_sets(const HostDevice& host, const DeviceFunctions& functions,
                                    const Pipelines& pipelines, const SystemLayout& layout,
                                    std::span<const BufferRange> ranges, const BufferRange& radiosity,
                                    const BufferRange& coefficients, VkDeviceSize max_texels);

}  // namespace relume
