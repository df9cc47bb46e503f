// SPDX-License-Identifier: MIT
//
// The descriptor sets of a solver, from a pool of its own: written once when the buffers are bound and never
// again, so that recording needs no extension and command buffers in flight share them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "compute/device_functions.h"
#include "compute/gpu_solver.h"
#include "compute/pipelines.h"
#include "compute/solver_layout.h"

namespace relume {

struct SystemSets {
  VkDescriptorSet system = VK_NULL_HANDLE;
  std::vector<VkDescriptorSet> bounce;  ///< per block
  std::vector<VkDescriptorSet> gather;  ///< per block
};

struct DescriptorSets {
  std::vector<VulkanHandle<VkBufferView>> texel_views;
  VulkanHandle<VkDescriptorPool> pool;
  std::array<VkDescriptorSet, 2> solve{};  ///< by the half that is read
  std::vector<SystemSets> systems;
};

/// `ranges` has one entry per buffer of the layout. Texel buffers show no more than `max_texels` elements; a
/// device that has fewer than a buffer holds must use MatrixFetch::storage.
Result<DescriptorSets> make_descriptor_sets(const HostDevice& host, const DeviceFunctions& functions,
                                            const Pipelines& pipelines, const SolverLayout& layout,
                                            std::span<const BufferRange> ranges, VkDeviceSize max_texels);

}  // namespace relume
