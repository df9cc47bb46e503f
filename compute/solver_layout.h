// SPDX-License-Identifier: MIT
//
// Where everything of a model lies on a device, and which dispatches make up a pass: plain numbers, no Vulkan
// objects.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "compute/host_device.h"
#include "core/model.h"
#include "core/result.h"
#include "core/sender_leaves.h"
#include "kernels/shared/bindings.h"

namespace relume {

/// Limits of a device that decide the layout.
struct LayoutLimits {
  VkDeviceSize max_range = VkDeviceSize{128} << 20;  ///< maxStorageBufferRange
  VkDeviceSize alignment = 256;                      ///< of storage and texel buffer offsets, a power of two
};

/// Buffers of the whole solve come first, in this order.
enum SolveBuffer : std::uint32_t {
  kRadiosityA,
  kRadiosityB,
  kAlbedo,
  kExitance,
  kDirect,
  kWeights,
  kResidual,
  kSolveBuffers,
};

/// A part of a buffer.
struct Section {
  VkDeviceSize offset = 0;
  VkDeviceSize byte_size = 0;
};

/// A block of a matrix: one buffer with four sections, in the order of the bindings of
/// kernels/shared/bindings.h.
struct BlockLayout {
  std::uint32_t buffer = 0;
  std::array<Section, kernels::kBlockBindings> sections;
};

struct SystemLayout {
  std::uint32_t first_cluster = 0;  ///< among the clusters of all systems
  std::uint32_t imports = 0;
  std::uint32_t import_ranges = 0;  ///< records after those of the imports: ranges of nodes above the systems
  std::uint32_t gather_rows = 0;
  std::uint32_t import_shares = 0;  ///< of the leaves of imports that are nodes
  std::uint32_t imports_buffer = 0;
  std::uint32_t import_shares_buffer = 0;
  std::uint32_t local_radiosity_buffer = 0;
  std::uint32_t irradiance_buffer = 0;
  std::vector<BlockLayout> bounce;
  std::vector<BlockLayout> gather;
};

struct SolverLayout {
  std::uint32_t clusters = 0;  ///< of all systems; also the number of the first sky patch among senders
  std::uint32_t sky_patches = 0;
  std::vector<BufferRequirement> buffers;
  std::vector<SystemLayout> systems;
};

/// Bytes of an RGB quantity per element on the device (vec4).
inline constexpr VkDeviceSize kRgbBytes = 16;

/// Fails with no_device when a buffer is larger than `max_range`. The model must be valid (check_model).
Result<SolverLayout> solver_layout(const Model& model, const LayoutLimits& limits);

/// Shares that an import has on the device: none for a leaf, which is copied.
std::uint32_t share_count(const SenderRef& sender, const SenderLeaves& leaves);

/// Elements of the largest texel buffer of a block.
VkDeviceSize largest_texel_buffer(const SolverLayout& layout);

}  // namespace relume
