// SPDX-License-Identifier: MIT
//
// Direct irradiance H from punctual lights, with shadows, on a device that somebody else owns: what
// precompute/direct_irradiance.h does on the processor, by the definition of core/light_patches.h. A guest
// like GpuSolver, whose header explains buffers, uploads, staging and recording.
//
// The life of it: create; the host provides buffers() and binds them; record_upload of model_data. Then each
// frame: LightSchedule::set_lights with the lights of the frame, and record() until the schedule is complete,
// at once or over several frames. Only what a changed light reaches is traced again
// (compute/light_schedule.h), and the result is that of a full trace to the bit.
//
// An object covers some systems of a model, against the occluders of all of it. Several objects of one model
// may be bound to the same first three buffers (tree, triangles, opacity), which one of them uploads.
//
// Synchronisation: record() TRANSFER write -> COMPUTE_SHADER write of cluster_light() and gather_light(),
// which is made visible to COMPUTE_SHADER and to TRANSFER reads. Left behind: the bound compute pipeline,
// descriptor set 0 and push constants [0, 48) of the compute bind point.
//
// Other ways to H: a host that has it from its shadow maps writes cluster_light() itself and records nothing
// here. With LightVisibility::mask, it writes one number per light and cluster, the share of the light that
// arrives, and no rays are traced; after changing it, LightSchedule::retrace().
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "compute/host_device.h"
#include "compute/light_schedule.h"
#include "compute/solver_options.h"
#include "compute/upload.h"
#include "core/light_patches.h"
#include "core/model.h"
#include "core/result.h"

namespace relume {

enum class LightVisibility : std::uint32_t { traced, mask };

struct DirectLightOptions {
  std::vector<std::uint32_t> systems{};  ///< ascending; empty: all that are loaded
  LightVisibility visibility = LightVisibility::traced;
  /// About how many shadow rays a light costs for each lumel (more close to it), at most kPatchesPerElement.
  /// Two are enough for what light does indirectly; penumbras of direct light in a lightmap want them all.
  double patches_per_element = kPatchesPerElement;
  std::uint32_t max_lights = 16384;
  /// A light counts one pair for each block of up to 32 elements that it may reach (LightSchedule::pairs_of);
  /// 128 bytes each. 0: room for 64 lights that reach everything, and at least 262,144.
  std::uint32_t max_pairs = 0;
  /// No dispatch traces more shadow rays, unless a single pair does: below 50 ms on two cores of a processor.
  std::uint64_t max_dispatch_rays = 16384;
  std::optional<MatrixFetch> fetch{};  ///< of the tree; nothing: texels, if texel buffers are large enough
};

/// Entries of DirectLight::buffers(), in this order.
enum DirectLightBuffer : std::uint32_t {
  kLightTree,
  kLightTriangles,
  kLightOpacity,
  kLightPieces,
  kLightPatches,
  kLightElements,
  kLightTables,
  kLightRecords,
  kLightWork,
  kLightShares,
  kElementLight,
  kClusterLight,
  kGatherLight,
  kLightMask,
  kDirectLightBuffers,
};

/// What a part of a trace came to.
struct LightPart {
  bool complete = false;   ///< nothing is left of the schedule
  std::uint64_t cost = 0;  ///< shadow rays, about
};

struct DirectLightState;

class DirectLight {
 public:
  /// The model must be valid (check_model); it is read, not kept. Fails with no_device when the device cannot
  /// bind a buffer of this size.
  static Result<DirectLight> create(const HostDevice& host, const Model& model,
                                    const DirectLightOptions& options);

  DirectLight(DirectLight&&) noexcept;
  DirectLight& operator=(DirectLight&&) noexcept;
  /// No command buffer of it may be running.
  ~DirectLight();

  /// What the host has to provide, by DirectLightBuffer. kClusterLight may be any storage buffer of four
  /// floats per cluster: GpuSolver::input(system, Quantity::direct) for an
  /// object that covers one system.
  std::span<const BufferRequirement> buffers() const;

  /// One range per entry of buffers(). To be called once.
  Result<void> bind(std::span<const BufferRange> ranges);

  /// Tree, patches, tables, and no light yet. Refers to nothing. `occluders`: the first three buffers too.
  UploadData model_data(const Model& model, bool occluders = true) const;

  /// As GpuSolver::record_upload.
  bool record_upload(VkCommandBuffer commands, const UploadData& data, const Staging& staging,
                     UploadCursor& cursor) const;

  /// Nothing traced yet, no lights.
  LightSchedule make_schedule() const;

  /// Staging memory with which record() can do at least one block of so many lights.
  VkDeviceSize staging_bytes(std::size_t lights) const;

  /// Takes the next blocks of the schedule, about `max_rays` shadow rays (the cost of the part) but at least
  /// one block, and brings H of their elements, clusters and gather rows up to date. The staging memory
  /// belongs to the command buffer until it has run. Changes the schedule and nothing else; not even that
  /// when the staging memory is smaller than staging_bytes().
  LightPart record(VkCommandBuffer commands, LightSchedule& schedule, const Staging& staging,
                   std::uint64_t max_rays) const;

  /// Segments to trace on their own, for measurements and tests: `count` of them lie in the work buffer
  /// (eight floats each: from, 0, to, 0) and the share of light that gets along goes into the shares (one
  /// float each). At most `max_shadow_rays()`. Barriers as record().
  void record_shadow_rays(VkCommandBuffer commands, std::uint32_t count) const;
  std::uint32_t max_shadow_rays() const;

  /// Any buffer as it was bound.
  BufferRange buffer(DirectLightBuffer which) const;

  /// H of the clusters of its systems, system by system: four floats each, lm/m2, the last is 0.
  BufferRange cluster_light() const { return buffer(kClusterLight); }
  /// H of their gather rows (lumels, sensors), likewise.
  BufferRange gather_light() const { return buffer(kGatherLight); }

  std::uint32_t cluster_count() const;
  std::uint32_t gather_row_count() const;

 private:
  explicit DirectLight(std::unique_ptr<DirectLightState> state);
  std::unique_ptr<DirectLightState> state_;
};

}  // namespace relume
