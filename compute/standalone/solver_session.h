// SPDX-License-Identifier: MIT
//
// A GpuSolver on a StandaloneDevice, with memory, staging and readback: each verb submits and waits.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "compute/gpu_solver.h"
#include "compute/standalone/standalone_device.h"
#include "compute/standalone/standalone_memory.h"
#include "core/directional_irradiance.h"
#include "core/methods/room_correction.h"
#include "core/model.h"
#include "core/probe_coefficients.h"
#include "core/result.h"
#include "core/solve.h"

namespace relume {

struct SessionLimits {
  std::uint64_t max_submit_form_factors = 32'000'000;
  double timeout_seconds = 60.0;
};

class SolverSession {
 public:
  /// All systems of `model` that are loaded. The device must outlive the session.
  static Result<SolverSession> create(StandaloneDevice& device, const Model& model,
                                      const SolverOptions& options, const SessionLimits& limits);

  const GpuSolver& solver() const { return solver_; }
  std::uint64_t device_bytes() const { return arena_.byte_size(); }
  double upload_seconds() const { return upload_seconds_; }  ///< of the matrices
  std::uint64_t bounce_cost() const;                         ///< form factors of one bounce of all systems

  Result<SubmitTimes> upload(const UploadData& data);

  /// Lighting of all systems, and the weights of a contraction bound (empty: all 1). Arrays as in
  /// core/solve.h. `number`: of a solver of several lightings, which share albedo and weights.
  Result<void> light(const Lighting& lighting, const std::vector<Rgb>& weights, std::uint32_t number = 0);

  /// The latest radiosity from now on.
  Result<void> set_radiosity(const std::vector<Rgb>& radiosity);

  /// rho K v on the device, by a bounce of a scene without light of its own: `lighting` is that of the last
  /// light(), with exitance, direct irradiance and sky black. What was the latest radiosity is lost.
  Result<std::vector<Rgb>> multiply(const std::vector<Rgb>& v);

  /// For PassWishes::correct, from now on. `weights`: of at most kMaxDeviceRooms rooms.
  Result<void> correct_by(const Model& model, const RoomWeights& weights);

  /// The systems together, in as many submissions as the limits ask for (its own limit is not looked at),
  /// each recorded so many `times` over: what a fast device does in a moment can be timed.
  Result<SubmitTimes> run(PassWishes wishes, std::uint32_t times = 1);

  /// What the last bounce changed, over all systems and lightings; after run() with PassWishes::residual.
  Result<Residual> residual();

  /// Latest radiosity of the clusters of all systems, or that which the last bounce read.
  Result<std::vector<Rgb>> read_radiosity(std::uint32_t lighting = 0);
  Result<std::vector<Rgb>> read_previous_radiosity();

  /// Irradiance of the gather rows of all systems.
  Result<std::vector<Rgb>> read_irradiance(std::uint32_t lighting = 0);

  /// Moments of the irradiance of the gather rows of all systems, 0 of systems without directions; none where
  /// no system has directions.
  Result<std::vector<IrradianceMoments>> read_directional_irradiance(std::uint32_t lighting = 0);

  /// Of the light probes of all systems, by their names; 0 of those that are not loaded.
  Result<std::vector<ProbeCoefficients>> read_probes(std::uint32_t lighting = 0);

 private:
  SolverSession(StandaloneDevice& device, const Model& model, const SessionLimits& limits, GpuSolver solver,
                std::uint32_t lightings);

  Result<void> provide_memory();
  Result<void> load(const Model& model);
  Result<std::vector<Rgb>> read_radiosity(std::uint32_t lighting, bool latest);
  Result<std::vector<std::byte>> read(const BufferRange& range);
  Result<void> append_rgb(const BufferRange& range, std::vector<Rgb>& values);

  StandaloneDevice* device_;
  std::vector<std::uint32_t> first_cluster_;  ///< per system, and the total
  SessionLimits limits_;
  std::uint32_t lightings_;
  double upload_seconds_ = 0.0;
  Schedule schedule_;
  // The solver goes before the memory that it is bound to.
  DeviceArena arena_;
  DeviceBuffer staging_;
  DeviceBuffer readback_;
  GpuSolver solver_;
};

}  // namespace relume
