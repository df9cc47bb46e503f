// SPDX-License-Identifier: MIT
//
// Lights that change their colour or intensity and nothing else cost no product: the irradiance that each
// gives alone is kept, and a frame adds them up (core/light_responses.h).
//
// The life of a cache, one per system: create; the host provides buffers() and binds them with
// GpuSolver::irradiance(system). For each light, the host has the solver light the scene by it alone, white
// and with an intensity of 1, bounces until that is good enough (GpuSolver::plan, record_frame), and records
// record_keep behind it. A solver of several lightings (SolverOptions::lightings) does so many lights at a
// time, one in each, and record_keep takes GpuSolver::irradiance(system, lighting). From then on, a frame in
// which only colours changed is record instead of bounces and gather; lightmaps are written from the
// irradiance as ever. New albedos or places need new responses.
//
// Synchronisation: both record functions begin with a barrier after, and end with one before, all
// COMPUTE_SHADER and TRANSFER work on the queue. record leaves behind the bound compute pipeline, descriptor
// set 0 and push constants [0, 8) of the compute bind point.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "compute/device_functions.h"
#include "compute/host_device.h"
#include "compute/kernel_set.h"
#include "core/quantities.h"
#include "core/result.h"

namespace relume {

/// vkCmdUpdateBuffer takes the colours of so many.
inline constexpr std::uint32_t kMaxCachedLights = 4096;

class LightCache {
 public:
  /// For gather rows of a system and lights. Fails with usage for none of either or more than
  /// kMaxCachedLights, with no_device when their responses (16 bytes each) are more than every device can
  /// bind.
  static Result<LightCache> create(const HostDevice& host, std::uint32_t rows, std::uint32_t lights);

  std::span<const BufferRequirement> buffers() const { return buffers_; }

  /// One range per entry of buffers(), and the irradiance of the rows. To be called once; all of it must
  /// outlive its use.
  Result<void> bind(std::span<const BufferRange> ranges, const BufferRange& irradiance);

  /// The irradiance that is there becomes the response to light number `light`; or that of the rows in
  /// `irradiance`, which is of another lighting.
  void record_keep(VkCommandBuffer commands, std::uint32_t light) const;
  void record_keep(VkCommandBuffer commands, std::uint32_t light, const BufferRange& irradiance) const;

  /// Writes the irradiance under lights of these colours times intensities, from the first on; the others are
  /// off.
  void record(VkCommandBuffer commands, std::span<const Rgb> colors) const;

 private:
  LightCache(const DeviceFunctions& functions, KernelSet kernels)
      : functions_(functions), kernels_(std::move(kernels)) {}

  DeviceFunctions functions_;
  KernelSet kernels_;
  std::vector<BufferRequirement> buffers_;
  std::uint32_t rows_ = 0;
  std::uint32_t lights_ = 0;
  std::vector<BufferRange> ranges_;  ///< responses, colours, irradiance
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace relume
