// SPDX-License-Identifier: MIT
//
// The layouts and pipelines of all kernels on one device.
#pragma once

#include <array>
#include <map>
#include <utility>

#include "compute/device_functions.h"
#include "compute/host_device.h"
#include "compute/kernel_code.h"
#include "compute/pass_plan.h"
#include "compute/pipeline_objects.h"
#include "compute/vulkan_handle.h"
#include "core/block_matrix.h"
#include "core/result.h"
#include "kernels/shared/bindings.h"

namespace relume {

/// What all kernels of a solver are compiled for.
struct KernelConstants {
  float sender_scale = 0.0f;    ///< of imports in half precision, a power of two; 0: single precision
  std::uint32_t lightings = 1;  ///< SolverOptions::lightings
};

/// The kernel that does a step, on rows in tiles of `tile_rows`.
KernelId step_kernel_id(StepKernel step, RowKernel row_kernel, std::uint32_t tile_rows);

/// What a set of kernels/shared/bindings.h binds.
SetShape set_shape(std::uint32_t set);

class Pipelines {
 public:
  /// Layouts only. Everything of `host` is borrowed.
  static Result<Pipelines> create(const HostDevice& host, const DeviceFunctions& functions,
                                  const KernelConstants& constants);

  /// Makes the pipeline of a kernel for a format, unless it is there. Kernels that decode nothing have the
  /// format {}.
  Result<void> add(KernelId kernel, const BlockFormat& format);

  /// A pipeline that was added.
  VkPipeline get(KernelId kernel, const BlockFormat& format) const {
    return pipelines_.at({kernel, format}).get();
  }

  VkPipelineLayout layout() const { return layout_.get(); }
  VkDescriptorSetLayout set_layout(std::uint32_t set) const { return set_layouts_[set].get(); }

 private:
  Pipelines(const HostDevice& host, const DeviceFunctions& functions, const KernelConstants& constants)
      : host_(host), functions_(functions), constants_(constants) {}

  HostDevice host_;
  DeviceFunctions functions_;
  KernelConstants constants_;
  std::array<VulkanHandle<VkDescriptorSetLayout>, kernels::kSets> set_layouts_;
  VulkanHandle<VkPipelineLayout> layout_;
  std::map<std::pair<KernelId, BlockFormat>, VulkanHandle<VkPipeline>> pipelines_;
};

}  // namespace relume
