// SPDX-License-Identifier: MIT
//
// What a pass with kernels of its own needs: one shape of descriptor set (set 0), push constants, the
// pipelines of its kernels, and a pool of sets. Sets are written when they are made and never again, so that
// command buffers in flight share them.
//
//   auto set = KernelSet::create(host, functions, {.shape = {.storage_buffers = 3}, .push_constant_bytes =
//   16,
//                                                  .kernels = {{KernelId::start}}, .max_sets = 1});
//   const auto bound = set->make_set(ranges);           // once the host's buffers are known
//   set->record(commands, 0, *bound, std::as_bytes(std::span(&constants, 1)), workgroups);
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/device_functions.h"
#include "compute/host_device.h"
#include "compute/kernel_code.h"
#include "compute/pipeline_objects.h"
#include "compute/vulkan_handle.h"
#include "core/result.h"

namespace relume {

struct KernelChoice {
  KernelId kernel;
  std::vector<std::uint32_t> constants{};  ///< values of specialization constants 0, 1, ...
};

struct KernelSetInfo {
  SetShape shape{};
  std::uint32_t push_constant_bytes = 0;  ///< a multiple of 4, at most 128
  std::vector<KernelChoice> kernels{};
  std::uint32_t max_sets = 1;
};

/// A part of a buffer that a kernel reads as texels.
struct TexelRange {
  BufferRange range;
  VkFormat format = VK_FORMAT_UNDEFINED;
};

/// An image that a kernel samples.
struct SampledImage {
  VkImageView view = VK_NULL_HANDLE;
  VkSampler sampler = VK_NULL_HANDLE;
  VkImageLayout layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;  ///< while the kernel runs
};

class KernelSet {
 public:
  /// Compiles all pipelines. Fails with no_device or out_of_memory.
  static Result<KernelSet> create(const HostDevice& host, const DeviceFunctions& functions,
                                  const KernelSetInfo& info);

  /// A set that binds these in the order of SetShape, as many of each as the shape has; storage images are in
  /// layout GENERAL. What it binds must outlive its use. Sets live as long as this. At most max_sets. Fails
  /// with usage for wrong numbers.
  Result<VkDescriptorSet> make_set(std::span<const BufferRange> buffers,
                                   std::span<const TexelRange> texels = {},
                                   std::span<const VkImageView> images = {},
                                   std::span<const SampledImage> sampled = {});

  /// Binds kernel number `kernel` of KernelSetInfo and the set, sets all push constants (as many bytes as
  /// were announced) and dispatches. No barriers.
  void record(VkCommandBuffer commands, std::uint32_t kernel, VkDescriptorSet set,
              std::span<const std::byte> push_constants, std::uint32_t workgroups_x,
              std::uint32_t workgroups_y = 1) const;

 private:
  KernelSet(const HostDevice& host, const DeviceFunctions& functions, const SetShape& shape)
      : host_(host), functions_(functions), shape_(shape) {}

  Result<std::vector<VkBufferView>> make_views(std::span<const TexelRange> texels);
  Result<VkDescriptorSet> allocate_set();

  HostDevice host_;
  DeviceFunctions functions_;
  SetShape shape_;
  VulkanHandle<VkDescriptorSetLayout> set_layout_;
  VulkanHandle<VkPipelineLayout> layout_;
  std::vector<VulkanHandle<VkPipeline>> pipelines_;
  std::vector<VulkanHandle<VkBufferView>> views_;
  VulkanHandle<VkDescriptorPool> pool_;
};

}  // namespace relume
