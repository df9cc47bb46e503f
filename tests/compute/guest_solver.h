// SPDX-License-Identifier: MIT
//
// A model on a device of the fake host: memory with guards, a solver bound to it, a schedule.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "compute/fake_host.h"
#include "compute/gpu_solver.h"
#include "compute/standalone/solve_on_device.h"

namespace relume::test {

class Guest {
 public:
  /// Loads what is loaded in `model`, which must outlive it, and lights it.
  Guest(StandaloneDevice& device, const HostDevice& host, const Model& model, const Lighting& lighting,
        const SolverOptions& options = {}, const std::vector<Rgb>& weights = {});

  GpuSolver& solver() { return *solver_; }
  const GuardedMemory& memory() const { return *memory_; }
  Schedule& schedule() { return schedule_; }
  /// A system's own memory, as asked for.
  VkDeviceSize system_bytes(std::uint32_t system) const;

  /// Waits for the device. `lighting` of all that `model` has loaded.
  void load(const Model& model, std::uint32_t system, const Lighting& lighting);
  /// Albedo, exitance and direct light of a system; the arrays are those of all systems of `model`.
  void light(const Model& model, std::uint32_t system, const Lighting& lighting,
             const std::vector<Rgb>& weights = {});
  void light_sky(const Lighting& lighting);
  /// Frees its memory too.
  void unload(std::uint32_t system);

  /// Submits the pass and waits.
  void together(const PassWishes& wishes);
  /// Submits one frame and waits.
  FramePlan frame(const FrameWishes& wishes, const FrameOutputs& outputs = {});

  /// Of some other pass, to its buffers.
  void upload(const std::vector<BufferRange>& targets, UploadData data);

  std::vector<Rgb> radiosity(bool latest = true) const;
  std::vector<Rgb> radiosity(std::uint32_t system) const;
  std::vector<Rgb> irradiance() const;
  std::vector<IrradianceMoments> moments() const;
  std::vector<ProbeCoefficients> probes() const;
  std::vector<Rgb> irradiance(std::uint32_t system) const;

  DeviceSolution results(std::uint32_t bounces) const;
  /// Nothing outside of the buffers was written, and all is what the reference says after so many bounces.
  testing::AssertionResult correct(std::uint32_t bounces) const;

 private:
  void upload(const UploadData& data);

  StandaloneDevice& device_;
  const Model& model_;
  const Lighting& lighting_;
  std::unique_ptr<GuardedMemory> memory_;
  std::map<std::uint32_t, std::vector<BufferRange>> ranges_;
  Schedule schedule_;
  std::optional<GpuSolver> solver_;
};

/// A bound on the radiosity of any surface or sky patch: max (M + rho H) / (1 - max rho), as row sums are at
/// most 1.
double largest_radiosity(const Lighting& lighting);

}  // namespace relume::test
