// SPDX-License-Identifier: MIT
#include "tool/solver.h"

#include <fmt/format.h>

#include <cmath>

#include "compute/standalone/light_session.h"
#include "compute/standalone/solve_on_device.h"
#include "compute/standalone/standalone_device.h"
#include "core/reference_solver.h"
#include "tool/interrupt.h"
#include "tool/stopwatch.h"

namespace relume {
namespace {

/// Shows how far the error bound is on its way from the first one to the tolerance, on a scale of powers.
BounceObserver show_progress(const StopRule& rule, Console& console) {
  return [rule, &console, first = 0.0](std::uint32_t bounces, double error_bound) mutable {
    if (first == 0.0) first = error_bound;
    const double by_count = double(bounces) / rule.max_bounces;
    const bool shrinks = rule.tolerance > 0.0 && error_bound > 0.0 && first > rule.tolerance;
    const double by_error = shrinks ? std::log(first / error_bound) / std::log(first / rule.tolerance) : 0.0;
    console.progress("bounces", std::max(by_count, by_error));
    return !interrupted();
  };
}

Result<SolveOutcome> solve_by_reference(const Model& model, const Lighting& lighting, const StopRule& rule,
                                        Console& console) {
  Stopwatch watch;
  const ReferenceMatrices matrices = reference_matrices(model);
  const double decode = watch.lap();
  Result<Solution> solution = solve_reference(matrices.bounce, lighting, rule, show_progress(rule, console));
  if (!solution) return tl::unexpected(solution.error());
  const double bounces = watch.lap();
  SolveOutcome outcome;
  outcome.gathered = gather(matrices.gather, lighting, solution->radiosity);
  outcome.solution = std::move(*solution);
  outcome.device = "reference";
  outcome.seconds = {{"decode", decode}, {"bounces", bounces}, {"gather", watch.lap()}};
  return outcome;
}

JsonObject seconds_json(const DeviceSeconds& seconds, double device) {
  return {{"device", device},
          {"contraction", seconds.contraction},
          {"create", seconds.create},
          {"upload", seconds.upload},
          {"bounces", seconds.bounces},
          {"gather", seconds.gather},
          {"download", seconds.download},
          {"gpu_bounces", seconds.gpu_bounces},
          {"gpu_gather", seconds.gpu_gather}};
}

Result<SolveOutcome> solve_by_vulkan(const Model& model, const Lighting& lighting, const StopRule& rule,
                                     const SolverChoice& choice, Console& console) {
  Stopwatch watch;
  Result<StandaloneDevice> device = StandaloneDevice::create({.device_name = choice.device_name});
  if (!device) return tl::unexpected(device.error());
  const double device_seconds = watch.lap();
  DeviceSolveOptions options;
  options.kernel = row_kernel_from_name(choice.kernel);
  options.observer = show_progress(rule, console);
  Result<DeviceSolution> solved = solve_on_device(*device, model, lighting, rule, options);
  if (!solved) return tl::unexpected(solved.error());
  if (solved->limited_by_rounding) {
    console.warn(fmt::format(
        "The tolerance {} is finer than 32-bit rounding lets this device reach; it stopped at {:.2g}.",
        rule.tolerance, solved->solution.error_bound));
  }
  SolveOutcome outcome;
  outcome.solution = std::move(solved->solution);
  outcome.rounding_bound = solved->rounding_bound;
  outcome.gathered = std::move(solved->irradiance);
  outcome.device = std::move(solved->device);
  outcome.kernel = std::move(solved->kernel);
  outcome.seconds = seconds_json(solved->seconds, device_seconds);
  return outcome;
}

}  // namespace

const std::vector<std::string>& kernel_names() {
  static const std::vector<std::string> names{std::string(row_kernel_name(RowKernel::row_per_thread)),
                                              std::string(row_kernel_name(RowKernel::row_per_8_lanes))};
  return names;
}

Result<std::vector<Rgb>> direct_by_vulkan(const Model& model, const std::vector<Light>& lights,
                                          const std::string& device_name) {
  Result<StandaloneDevice> device = StandaloneDevice::create({.device_name = device_name});
  if (!device) return tl::unexpected(device.error());
  Result<DeviceDirectLight> direct = direct_light_on_device(*device, model, lights);
  if (!direct) return tl::unexpected(direct.error());
  return std::move(direct->clusters);
}

Result<SolveOutcome> solve(const Model& model, const Lighting& lighting, const StopRule& rule,
                           const SolverChoice& choice, Console& console) {
  Result<SolveOutcome> outcome = choice.reference ? solve_by_reference(model, lighting, rule, console)
                                                  : solve_by_vulkan(model, lighting, rule, choice, console);
  console.end_progress();
  return outcome;
}

}  // namespace relume
