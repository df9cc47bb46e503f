// SPDX-License-Identifier: MIT
//
// A renderer without pictures on a StandaloneDevice: each frame is one command buffer, with everything that
// Relume does for it, and a wait. For benchmarks and programs that go through frames; and what a host does.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "compute/direct_light.h"
#include "compute/gpu_solver.h"
#include "compute/lightmap_pass.h"
#include "compute/material_pass.h"
#include "compute/standalone/standalone_device.h"
#include "compute/standalone/standalone_image.h"
#include "compute/standalone/standalone_memory.h"
#include "compute/standalone/timestamps.h"
#include "core/model.h"
#include "core/result.h"

namespace relume {

struct FrameSessionOptions {
  SolverOptions solver{};
  MaterialPassOptions materials{};
  LightmapFormat lightmaps = LightmapFormat::rgba16f;  ///< of direct and indirect light together
  std::uint32_t max_pairs = 0;                         ///< of each system: DirectLightOptions
  double patches_per_element = kPatchesPerElement;     ///< likewise
};

/// What is shown from this frame on.
struct FrameContent {
  std::span<const Light> lights{};  ///< all of them, world space
  /// Of each material of the model (StatePer::cluster: of each cluster of all systems); empty: as before.
  std::span<const kernels::MaterialState> materials{};
  std::span<const Rgb> sky{};  ///< lm/m2 per patch; empty: as before
  std::uint32_t bounces = 1;   ///< from the radiosity of the frame before; in the first frame from M + rho H
};

/// Seconds of a frame. The device's are between timestamps, 0 where the queue has none.
struct FrameTimes {
  double host = 0.0;          ///< from set_lights to the end of the wait
  double inputs = 0.0;        ///< device: copies, nodes of the sky, materials
  double direct_light = 0.0;  ///< device
  double bounces = 0.0;       ///< device
  double gather = 0.0;        ///< device
  double lightmaps = 0.0;     ///< device
  std::uint64_t shadow_rays = 0;

  double device() const { return inputs + direct_light + bounces + gather + lightmaps; }
};

class FrameSession {
 public:
  /// All systems of `model` that are loaded, with colours as stored. The device must outlive the session.
  static Result<FrameSession> create(StandaloneDevice& device, const Model& model,
                                     const FrameSessionOptions& options);

  FrameSession(FrameSession&&) noexcept;
  FrameSession& operator=(FrameSession&&) noexcept;
  ~FrameSession();

  /// All systems together, to the end.
  Result<FrameTimes> frame(const FrameContent& content);

  const GpuSolver& solver() const;
  std::uint64_t entries() const;  ///< of a bounce and a gather of all systems, zeros of tiles included

  /// Of all clusters, gather rows, or texels of a system, after the last frame: albedo; H and B (lm/m2);
  /// irradiance through form factors (lm/m2); direct irradiance of gather rows.
  Result<std::vector<Rgb>> read_albedo();
  Result<std::vector<Rgb>> read_direct();
  Result<std::vector<Rgb>> read_radiosity();
  Result<std::vector<Rgb>> read_irradiance();
  Result<std::vector<Rgb>> read_gather_direct();
  /// Bytes of the lightmap of a system, row by row, in the session's format; empty: it has none.
  Result<std::vector<std::byte>> read_lightmap(std::uint32_t system);

 private:
  struct State;
  explicit FrameSession(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace relume
