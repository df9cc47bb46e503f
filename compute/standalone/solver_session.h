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
#include "core/model.h"
#include "core/result.h"
#include "core/solve.h"

namespace relume {

struct SessionLimits {
  std::uint64_t max_submit_form_factors = 32'000'000;
  double timeout_seconds = 60.0;
};

class SolverSession {
 public:
  /// The device must outlive the session.
  static Result<SolverSession> create(StandaloneDevice& device, const Model& model,
                                      const SolverOptions& options, const SessionLimits& limits);

  const GpuSolver& solver() const { return solver_; }
  std::uint64_t device_bytes() const { return arena_.byte_size(); }

  Result<SubmitTimes> upload(const UploadData& data);

  /// rho K v on the device, by a bounce of a scene without light of its own: `lighting` is that of the last
  /// upload, with exitance, direct irradiance and sky black. What was the latest radiosity is lost.
  Result<std::vector<Rgb>> multiply(const std::vector<Rgb>& v);

  /// B0, which becomes the latest radiosity.
  Result<SubmitTimes> start();

  /// `count` bounces from the latest radiosity, in as many submissions as the limits ask for.
  Result<SubmitTimes> bounce(std::uint32_t count);

  /// What the last bounce changed.
  Result<Residual> residual();

  /// Irradiance from the latest radiosity.
  Result<SubmitTimes> gather();

  /// Latest radiosity of the clusters of all systems, or that of the half which the last bounce read.
  Result<std::vector<Rgb>> read_radiosity();
  Result<std::vector<Rgb>> read_previous_radiosity();

  /// Irradiance of the gather rows of all systems.
  Result<std::vector<Rgb>> read_irradiance();

 private:
  SolverSession(StandaloneDevice& device, std::uint32_t systems, const SessionLimits& limits,
                GpuSolver solver)
      : device_(&device), systems_(systems), limits_(limits), arena_(device), solver_(std::move(solver)) {}

  Result<void> provide_memory();
  Result<std::vector<Rgb>> read_radiosity(RadiosityHalf half);
  Result<void> append_rgb(const BufferRange& range, std::vector<Rgb>& values);

  StandaloneDevice* device_;
  std::uint32_t systems_;
  SessionLimits limits_;
  RadiosityHalf latest_ = RadiosityHalf::a;
  // The solver goes before the memory that it is bound to.
  DeviceArena arena_;
  DeviceBuffer staging_;
  DeviceBuffer readback_;
  GpuSolver solver_;
};

}  // namespace relume
