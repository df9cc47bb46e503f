// SPDX-License-Identifier: MIT
//
// Where everything of a model lies on a device: plain numbers, no Vulkan objects.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "compute/host_device.h"
#include "core/model.h"
#include "core/result.h"
#include "kernels/shared/bindings.h"

namespace relume {

/// Limits of a device that decide the layout.
struct LayoutLimits {
  VkDeviceSize max_range = VkDeviceSize{128} << 20;  ///< maxStorageBufferRange
  VkDeviceSize alignment = 256;                      ///< of storage and texel buffer offsets, a power of two
  bool half_senders = false;                         ///< imports are kept in half precision
  std::uint32_t lightings = 1;                       ///< SolverOptions::lightings
};

/// Buffers of the whole solve. The first ones are the bindings of kSolveSet, in their order.
enum SolveBuffer : std::uint32_t {
  kRadiosity,
  kFirstSender,
  kResiduals,
  kSkyNodes,
  kSkyParts,
  kProbeCoefficients,
  kSolveBuffers
};

/// Buffers of a system: the bindings of kSystemSet, in their order, but for its part of the radiosity; those
/// of its blocks follow.
enum SystemBuffer : std::uint32_t {
  kImports,
  kLocalRadiosity,
  kIrradiance,
  kAlbedo,
  kExitance,
  kDirect,
  kWeights,
  kNodes,
  kNodeParts,
  kSystemBuffers,
};

/// Buffers of a block of light probes: the first bindings of kBlockSet for them, in their order.
enum ProbeBuffer : std::uint32_t { kProbeLists, kProbeSenders, kProbeBuffers };

/// A part of a buffer.
struct BlockSection {
  VkDeviceSize offset = 0;
  VkDeviceSize byte_size = 0;
};

/// A block of a matrix: one buffer with four sections, in the order of the bindings of
/// kernels/shared/bindings.h.
struct BlockLayout {
  std::uint32_t buffer = 0;                   ///< of the system
  VkFormat code_format = VK_FORMAT_R32_UINT;  ///< of kCodeTexelsBinding
  std::array<BlockSection, kernels::kBlockBindings> sections;
};

/// Light probes that stand together, so that their list fits a buffer of kMaxBlockBytes.
struct ProbeBlockLayout {
  std::uint32_t first_probe = 0;
  std::uint32_t probe_count = 0;
  std::uint32_t first_sender = 0;
  std::uint32_t sender_count = 0;
  std::uint32_t first_buffer = 0;  ///< of the system: its kProbeLists
};

/// What each lighting has of its own in a buffer: planes of equal size, one lighting after the other, aligned
/// so that each can be bound. (The local radiosity has those of a sender side by side, and is no such.)
struct LightingPlane {
  VkDeviceSize byte_size = 0;  ///< what is used of it
  VkDeviceSize step = 0;       ///< bytes from one lighting to the next
};

struct SystemLayout {
  std::uint32_t clusters = 0;
  std::uint32_t nodes = 0;
  std::uint32_t node_parts = 0;  ///< of all nodes together
  std::uint32_t imports = 0;
  std::uint32_t import_parts = 0;  ///< records after those of the imports: see kernels::kImportsBinding
  std::uint32_t gather_rows = 0;
  bool directional = false;   ///< the gather matrix has directions
  bool half_senders = false;  ///< see LayoutLimits
  std::uint32_t lightings = 1;
  LightingPlane clusters_plane;    ///< of exitance and direct
  LightingPlane irradiance_plane;  ///< irradiance per gather row, then three moments per gather row
  std::vector<BufferRequirement> buffers;
  std::vector<BlockLayout> bounce;
  std::vector<BlockLayout> gather;
  std::vector<ProbeBlockLayout> probes;

  /// Of one half of its radiosity.
  std::uint32_t senders() const { return clusters + nodes; }
};

struct SolverLayout {
  std::uint32_t systems = 0;  ///< loaded or not
  std::uint32_t sky_patches = 0;
  std::uint32_t sky_nodes = 0;
  std::uint32_t sky_node_parts = 0;   ///< of all nodes together
  std::uint32_t probes = 0;           ///< of all systems
  std::uint32_t sender_capacity = 0;  ///< senders of all systems that are loaded at a time, in one half
  std::uint32_t lightings = 1;
  LightingPlane radiosity_plane;
  LightingPlane probes_plane;
  std::vector<BufferRequirement> buffers;

  std::uint32_t sender_step = 1;  ///< what a system's first place is a multiple of

  std::uint32_t sky_senders() const { return sky_patches + sky_nodes; }

  /// Places in a plane of the radiosity buffer: the sky comes first, then room for two halves of every
  /// sender.
  std::uint32_t sky_places() const;
  std::uint32_t system_places() const;

  /// Of the records of all lightings: per system, lighting after lighting.
  VkDeviceSize residual_bytes() const;
};

/// Of the radiosity buffer, from place `first` on in the plane of the first lighting to the end of `count`
/// places in that of the last; never empty, as what is bound cannot be.
BufferRange radiosity_part(const SolverLayout& layout, const BufferRange& radiosity, std::uint32_t first,
                           std::uint32_t count);

/// Bytes of an RGB quantity per element on the device (vec4).
inline constexpr VkDeviceSize kRgbBytes = 16;

/// The same in half precision.
inline constexpr VkDeviceSize kHalfRgbBytes = 8;

/// Bytes of the moments of a gather row.
inline constexpr VkDeviceSize kMomentBytes = 3 * kRgbBytes;

/// Bytes of the coefficients of a probe.
inline constexpr VkDeviceSize kProbeBytes = kernels::kProbeHarmonics * kRgbBytes;

/// Senders of the systems that are loaded in `model`.
std::uint32_t loaded_senders(const Model& model);

/// Fails with no_device when a buffer is larger than `max_range`. The model must be valid (check_model).
Result<SolverLayout> solver_layout(const Model& model, std::uint32_t sender_capacity,
                                   const LayoutLimits& limits);

/// The same for one system, which is loaded in `model`.
Result<SystemLayout> system_layout(const Model& model, std::uint32_t system, const LayoutLimits& limits);

/// Elements of the largest texel buffer that kernels of a system read.
VkDeviceSize largest_texel_buffer(const SolverLayout& solver, const SystemLayout& layout);

}  // namespace relume
