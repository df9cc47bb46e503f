// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "compute/gpu_solver.h"
#include "compute/standalone/standalone_device.h"
#include "core/directional_irradiance.h"
#include "core/methods/methods.h"
#include "core/model.h"
#include "core/probe_coefficients.h"
#include "core/reference_solver.h"
#include "core/result.h"
#include "core/solve.h"

namespace relume {

/// For rows in tiles that of SolverOptions; else row_per_thread on a processor, row_per_8_lanes elsewhere.
/// Not measured: see tuned_row_kernel.
RowKernel default_row_kernel(const StandaloneDevice& device, const Model& model);

/// How to solve, and what the methods with two levels need.
struct DeviceMethod {
  /// bounces, two_level (PassWishes::correct, of at most kMaxDeviceRooms rooms), bicgstab or
  /// two_level_gmres: for these two the device does the products, and the processor the rest.
  Method method = Method::bounces;
  RoomWeights rooms{};        ///< of two_level
  NearAndFar near_and_far{};  ///< of two_level_gmres
};

/// Asked once the contraction is known; `bounces`: how many plain ones could be needed.
using MethodChooser = std::function<DeviceMethod(double bounces)>;

struct DeviceSolveOptions {
  /// Nothing: default_row_kernel. The result is the same to the bit.
  std::optional<RowKernel> kernel;
  std::optional<MatrixFetch> fetch{};  ///< see SolverOptions
  std::uint64_t max_dispatch_form_factors = 4'000'000;
  /// A submission has no more, but at least one dispatch.
  std::uint64_t max_submit_form_factors = 32'000'000;
  double timeout_seconds = 60.0;  ///< of one submission
  BounceObserver observer{};      ///< called after each residual, every few bounces
  MethodChooser choose_method{};  ///< none: plain bounces
};

struct DeviceSeconds {
  double create = 0.0;       ///< pipelines, buffers
  double upload = 0.0;       ///< matrices
  double rooms = 0.0;        ///< finding and loading them
  double contraction = 0.0;  ///< the contraction bound; the first dispatch compiles on some drivers
  double bounces = 0.0;      ///< with residuals and the upload of the lighting
  double gather = 0.0;
  double download = 0.0;
  double gpu_bounces = 0.0;  ///< by timestamps; 0 when the queue has none
  double gpu_gather = 0.0;
};

struct DeviceSolution {
  /// As solve_reference gives it. `error_bound` is of the iteration: what bounces not done would change.
  Solution solution;
  /// What 32-bit rounding can do on top, at worst, relative to max |B|: (ceil(n / 8) + 12) 2^-24 max(B / v) /
  /// (1 - q), n: the longest row; with nodes of at most m leaves ceil(m / 8) + 7 more, with nodes of p parts
  /// above the systems p + 4 more.
  double rounding_bound = 0.0;
  /// Where it did not help, Solution::fallback says that plain bounces went on.
  Method method = Method::bounces;
  double predicted_bounces =
      0.0;  ///< plain ones to the tolerance: ln tolerance / ln q; 0 without a tolerance
  /// The tolerance was not reached because rounding keeps the residual from falling further.
  bool limited_by_rounding = false;
  std::vector<Rgb> irradiance;             ///< lm/m2 per gather row of all systems
  std::vector<IrradianceMoments> moments;  ///< as directional_irradiance() gives them
  std::vector<ProbeCoefficients> probes;   ///< as probe_coefficients() gives them
  std::string device;
  std::string kernel;
  std::uint64_t device_bytes = 0;
  DeviceSeconds seconds;
};

/// The whole solve: bounces until the rule stops them (looked at every few bounces, so a few more than the
/// reference may be done; never more than max_bounces), then the gather. The model must be valid
/// (check_model). Fails as check_lighting and check_contraction do, with no_device or out_of_memory from the
/// device, with check_failed when a result is not finite, with cancelled when the observer says so.
Result<DeviceSolution> solve_on_device(StandaloneDevice& device, const Model& model, const Lighting& lighting,
                                       const StopRule& rule, const DeviceSolveOptions& options = {});

}  // namespace relume
