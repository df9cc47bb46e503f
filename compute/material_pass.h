// SPDX-License-Identifier: MIT
//
// Live materials: albedo and exitance of the clusters of a system, from what the precompute stored and what
// the host sets, per material or per cluster, in a buffer of its own.
//
// The life of a pass: create; the host provides buffers() and binds them; it uploads material_data once
// (compute/record_upload.h), which leaves everything as stored; from then on it writes the MaterialStates as
// it likes (kernels/shared/materials.h) and records a pass in each frame in which they changed. A screen pass
// (compute/screen_pass.h) goes behind it.
//
// Synchronisation: record begins with COMPUTE_SHADER reads of the states and writes of albedo and exitance,
// and ends with COMPUTE_SHADER writes of both, which are visible to COMPUTE_SHADER and to TRANSFER reads.
// Between record functions that run one after another on one queue the barriers are the pass's; behind the
// host's writes of the states they are the host's. Left behind: the bound compute pipeline, descriptor set 0
// and push constants [0, 12) of the compute bind point.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "compute/device_functions.h"
#include "compute/host_device.h"
#include "compute/kernel_set.h"
#include "compute/upload.h"
#include "core/model.h"
#include "core/quantities.h"
#include "core/result.h"
#include "kernels/shared/materials.h"

namespace relume {

/// What the clusters of a system have in a solver's buffers: four floats each.
struct ClusterColorRanges {
  BufferRange albedo;
  BufferRange exitance;  ///< lm/m2
};

/// What a MaterialState belongs to.
enum class StatePer : std::uint32_t {
  material,  ///< numbered as Model::materials
  cluster,   ///< of the system
};

/// Final values, as `relume solve --materials` has them: textures no longer matter. What is absent stays as
/// stored. The radiance is in cd/m2.
kernels::MaterialState replaced_material(const std::optional<Rgb>& albedo,
                                         const std::optional<Rgb>& radiance);

/// Stored colours times factors: what textures made of them stays.
kernels::MaterialState scaled_material(const Rgb& albedo_factor, const Rgb& exitance_factor);

struct MaterialPassOptions {
  StatePer states = StatePer::material;
  double max_albedo = 0.95;  ///< albedo above is lowered to it; at most 0.9999
};

class MaterialPass {
 public:
  /// Compiles the kernel. The model must be valid (check_model); it is read, not kept. Fails with no_device
  /// when a buffer is larger than every device can bind.
  static Result<MaterialPass> create(const HostDevice& host, const Model& model, std::uint32_t system,
                                     const MaterialPassOptions& options);

  /// First what is stored, then the states, which the host writes: a MaterialState per material or per
  /// cluster.
  std::span<const BufferRequirement> buffers() const { return buffers_; }

  /// Hands over one range per entry of buffers(), and where the colours go. To be called once; all of it must
  /// outlive its use.
  Result<void> bind(std::span<const BufferRange> ranges, const ClusterColorRanges& colors);

  /// Albedo and exitance of all clusters of the system. NaN and what is below zero become zero.
  void record(VkCommandBuffer commands) const;

 private:
  MaterialPass(const DeviceFunctions& functions, KernelSet kernels)
      : functions_(functions), kernels_(std::move(kernels)) {}

  DeviceFunctions functions_;
  KernelSet kernels_;
  std::vector<BufferRequirement> buffers_;
  kernels::MaterialConstants constants_{};
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

/// The bytes of MaterialPass::buffers(), with all states as stored. Refers to nothing.
UploadData material_data(const Model& model, std::uint32_t system, StatePer states);

}  // namespace relume
