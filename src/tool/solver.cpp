// SPDX-License-Identifier: MIT
#include "tool/solver.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "compute/room_tables.h"
#include "compute/standalone/solve_on_device.h"
#include "compute/standalone/standalone_device.h"
#include "compute/standalone/tune_row_kernel.h"
#include "core/methods/room_correction.h"
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

/// Sets method and reason of `outcome`.
Result<Solution> solve_by_choice(const Model& model, const SenderMatrix& bounce_matrix,
                                 const Lighting& lighting, const StopRule& rule,
                                 const std::optional<Method>& method, const BounceObserver& observer,
                                 SolveOutcome& outcome) {
  const bool plain = method == Method::bounces || (!method && rule.tolerance <= 0.0);
  outcome.method = method.value_or(Method::bounces);
  outcome.method_reason = method ? "asked for" : "a number of bounces was asked for";
  // All methods but bounces begin with a product.
  if (plain || rule.max_bounces == 0) return solve_reference(bounce_matrix, lighting, rule, observer);
  const auto problem = make_bounce_problem(bounce_matrix, lighting, cluster_areas(model));
  if (!problem) return tl::unexpected(problem.error());
  if (!method) {
    MethodChoice choice = choose_method(*problem, rule);
    outcome.method = choice.method;
    outcome.method_reason = std::move(choice.reason);
    outcome.scene = choice.scene;
  }
  const SceneLevels levels = scene_levels(outcome.method, model, bounce_matrix);
  return solve_by(outcome.method, *problem, levels, rule, observer);
}

Result<SolveOutcome> solve_by_reference(const Model& model, const Lighting& lighting, const StopRule& rule,
                                        const SolverChoice& choice, Console& console) {
  Stopwatch watch;
  const ReferenceMatrices matrices = reference_matrices(model);
  const double decode = watch.lap();
  SolveOutcome outcome;
  Result<Solution> solution = solve_by_choice(model, matrices.bounce, lighting, rule, choice.method,
                                              show_progress(rule, console), outcome);
  if (!solution) return tl::unexpected(solution.error());
  if (!solution->fallback.empty()) console.warn(solution->fallback + ".");
  const double bounces = watch.lap();
  outcome.gathered = gather(matrices.gather, lighting, solution->radiosity);
  outcome.moments = directional_irradiance(model, lighting, solution->radiosity);
  outcome.probes = probe_coefficients(model, lighting, solution->radiosity);
  outcome.solution = std::move(*solution);
  outcome.device = "reference";
  outcome.seconds = {{"decode", decode}, {"bounces", bounces}, {"gather", watch.lap()}};
  return outcome;
}

JsonObject seconds_json(const DeviceSeconds& seconds, double device, double tuning) {
  return {{"device", device},
          {"tuning", tuning},
          {"contraction", seconds.contraction},
          {"rooms", seconds.rooms},
          {"create", seconds.create},
          {"upload", seconds.upload},
          {"bounces", seconds.bounces},
          {"gather", seconds.gather},
          {"download", seconds.download},
          {"gpu_bounces", seconds.gpu_bounces},
          {"gpu_gather", seconds.gpu_gather}};
}

/// Where programs keep what they can find out again; empty: nowhere.
std::filesystem::path kernel_cache() {
  const auto folder = [](const char* name) -> std::filesystem::path {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
  };
  std::filesystem::path cache = folder("XDG_CACHE_HOME");
  if (cache.empty() && !folder("HOME").empty()) cache = folder("HOME") / ".cache";
  return cache.empty() ? cache : cache / "relume" / "kernels";
}

/// What was asked for, else what the device is fastest with.
Result<void> choose_kernel(StandaloneDevice& device, const Model& model, const std::string& asked_for,
                           DeviceSolveOptions& options) {
  options.kernel = row_kernel_from_name(asked_for);
  if (options.kernel) return {};
  const auto tuned = tuned_row_kernel(device, model, kernel_cache());
  if (!tuned) return tl::unexpected(tuned.error());
  options.kernel = tuned->kernel;
  // Texel buffers are the solver's own choice, where they fit.
  if (tuned->fetch == MatrixFetch::storage) options.fetch = tuned->fetch;
  return {};
}

/// BiCGSTAB needs a tenth to a third of the products, but each goes by way of the processor.
constexpr double kFewDeviceBounces = 60.0;
/// GMRES over two levels needs 5 to 20 products, but to find the levels takes as long as a hundred.
constexpr double kManyDeviceBounces = 800.0;

Result<void> check_device_method(const std::optional<Method>& method) {
  for (const Method known : {Method::bounces, Method::two_level, Method::bicgstab, Method::two_level_gmres}) {
    if (method.value_or(Method::bounces) == known) return {};
  }
  return fail(ErrorCode::usage,
              fmt::format("--method {} runs on --device reference only; a Vulkan device does bounces, "
                          "two-level, bicgstab and two-level-gmres",
                          method_names()[std::size_t(*method)]));
}

DeviceMethod device_method(const Model& model, const std::optional<Method>& asked_for, double bounces) {
  const Method fastest = bounces <= kFewDeviceBounces    ? Method::bounces
                         : bounces <= kManyDeviceBounces ? Method::bicgstab
                                                         : Method::two_level_gmres;
  const Method method = asked_for.value_or(fastest);
  if (method != Method::two_level && method != Method::two_level_gmres) return {method};
  const SenderMatrix bounce_matrix = reference_bounce_matrix(model);
  SceneLevels levels = scene_levels(method, model, bounce_matrix);
  if (method == Method::two_level_gmres) return {method, {}, std::move(levels.near_and_far)};
  const std::vector<double> areas = cluster_areas(model);
  return {method, room_weights(bounce_matrix, areas, largest_rooms(levels.rooms, areas, kMaxDeviceRooms))};
}

std::string reason_of(const DeviceSolution& solved, const StopRule& rule,
                      const std::optional<Method>& asked_for) {
  if (asked_for) return solved.method == *asked_for ? "asked for" : "no rooms were found to correct";
  if (rule.tolerance <= 0.0) return "a number of bounces was asked for";
  return fmt::format("bounces could take {:.0f}", solved.predicted_bounces);
}

Result<SolveOutcome> solve_by_vulkan(const Model& model, const Lighting& lighting, const StopRule& rule,
                                     const SolverChoice& choice, Console& console) {
  if (auto checked = check_device_method(choice.method); !checked) return tl::unexpected(checked.error());
  Stopwatch watch;
  Result<StandaloneDevice> device = StandaloneDevice::create({.device_name = choice.device_name});
  if (!device) return tl::unexpected(device.error());
  const double device_seconds = watch.lap();
  DeviceSolveOptions options;
  if (auto chosen = choose_kernel(*device, model, choice.kernel, options); !chosen)
    return tl::unexpected(chosen.error());
  const double tuning_seconds = watch.lap();
  options.observer = show_progress(rule, console);
  options.choose_method = [&](double bounces) { return device_method(model, choice.method, bounces); };
  Result<DeviceSolution> solved = solve_on_device(*device, model, lighting, rule, options);
  if (!solved) return tl::unexpected(solved.error());
  if (solved->limited_by_rounding) {
    console.warn(fmt::format(
        "The tolerance {} is finer than 32-bit rounding lets this device reach; it stopped at {:.2g}.",
        rule.tolerance, solved->solution.error_bound));
  }
  SolveOutcome outcome;
  if (!solved->solution.fallback.empty()) console.warn(solved->solution.fallback + ".");
  outcome.method = solved->method;
  outcome.method_reason = reason_of(*solved, rule, choice.method);
  outcome.solution = std::move(solved->solution);
  outcome.rounding_bound = solved->rounding_bound;
  outcome.gathered = std::move(solved->irradiance);
  outcome.moments = std::move(solved->moments);
  outcome.probes = std::move(solved->probes);
  outcome.device = std::move(solved->device);
  outcome.kernel = std::move(solved->kernel);
  outcome.seconds = seconds_json(solved->seconds, device_seconds, tuning_seconds);
  return outcome;
}

}  // namespace

const std::vector<std::string>& kernel_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const RowKernel kernel : kRowKernels) all.emplace_back(row_kernel_name(kernel));
    return all;
  }();
  return names;
}

Result<SolveOutcome> solve(const Model& model, const Lighting& lighting, const StopRule& rule,
                           const SolverChoice& choice, Console& console) {
  Result<SolveOutcome> outcome = choice.reference ? solve_by_reference(model, lighting, rule, choice, console)
                                                  : solve_by_vulkan(model, lighting, rule, choice, console);
  console.end_progress();
  return outcome;
}

}  // namespace relume
