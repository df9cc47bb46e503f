// SPDX-License-Identifier: MIT
#include "compute/standalone/solve_on_device.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "compute/row_kernels.h"
#include "compute/standalone/solve_by_products.h"
#include "compute/standalone/solver_session.h"
#include "kernels/shared/limits.h"

namespace relume {
namespace {

using Clock = std::chrono::steady_clock;

/// Seconds since the last call.
class Stopwatch {
 public:
  double lap() {
    const Clock::time_point now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  Clock::time_point last_ = Clock::now();
};

/// numerator / denominator per channel, the worst of them; a channel without light has no error.
double worst_ratio(const Rgb& numerator, const Rgb& denominator) {
  double worst = 0.0;
  for (int channel = 0; channel < 3; ++channel) {
    if (numerator[channel] != 0.0) worst = std::max(worst, numerator[channel] / denominator[channel]);
  }
  return worst;
}

double largest(const Rgb& value) {
  return std::max({value.x, value.y, value.z});
}

/// Entries of the longest row, zeros of its tile included.
std::uint32_t longest_row(const Model& model) {
  std::uint32_t longest = 0;
  for (const System& system : model.systems) {
    for (const MatrixBlock& block : system.bounce.blocks) {
      for (std::size_t tile = 0; tile + 1 < block.tile_offsets.size(); ++tile)
        longest = std::max(longest, block.tile_offsets[tile + 1] - block.tile_offsets[tile]);
    }
  }
  return longest;
}

/// Additions on the way of one term into the mean of the largest node of a tree, as a lane makes them; 0: no
/// system imports a node.
std::uint32_t longest_mean(const Model& model) {
  std::uint32_t longest = 0;
  const auto raise = [&longest](const ClusterTreeNodes& tree) {
    for (const TreeNode& node : tree.nodes) longest = std::max(longest, (node.count + 7) / 8);
  };
  raise(model.sky_tree);
  for (const System& system : model.systems) raise(system.tree);
  return longest;
}

/// Parts of the largest node above the systems.
std::uint32_t most_parts(const Model& model) {
  std::uint32_t most = 0;
  for (const SpanningNode& node : model.top_tree) most = std::max(most, node.part_count);
  return most;
}

/// Roundings of one bounce, each at most 2^-24 of its result: the product of an entry, the additions of its
/// lane, 3 of the tree, 3 of the scale, 3 of B = M + albedo (H + I), 2 of the stored albedo and exitance or
/// direct irradiance. Of the mean of a node: the stored share, its product, the additions of its lane, 3 of
/// the tree. Of a node above the systems: the stored share, its product, an addition a part.
double rounding_of_bounce(const Model& model) {
  const std::uint32_t terms = longest_mean(model), parts = most_parts(model);
  const double of_node = terms > 0 ? terms + 5.0 : 0.0;
  const double of_spanning = parts > 0 ? parts + 2.0 : 0.0;
  return (std::ceil(longest_row(model) / 8.0) + 12.0 + of_node + of_spanning) * 0x1p-24;
}

bool finite(const Residual& residual) {
  for (const Rgb& value : {residual.weighted_change, residual.change, residual.radiosity}) {
    if (!std::isfinite(value.x + value.y + value.z)) return false;
  }
  return true;
}

/// Tells a residual that rounding holds up from one that still falls.
class ProgressWatch {
 public:
  /// True once `bound` has not been below its lowest for some looks in a row.
  bool stalled(double bound) {
    looks_without_fall_ = bound < lowest_ ? 0 : looks_without_fall_ + 1;
    lowest_ = std::min(lowest_, bound);
    return looks_without_fall_ >= kPatience;
  }

 private:
  static constexpr int kPatience = 4;
  double lowest_ = std::numeric_limits<double>::infinity();
  int looks_without_fall_ = 0;
};

/// The bounces of one solve, corrected by the rooms of the session or not.
class BounceLoop {
 public:
  BounceLoop(SolverSession& session, const ContractionBound& contraction, double rounding,
             const StopRule& rule, const DeviceSolveOptions& options, std::uint32_t rooms)
      : session_(session),
        contraction_(contraction),
        rounding_(rounding),
        rule_(rule),
        options_(options),
        rooms_(rooms),
        correct_(rooms > 0) {}

  Result<void> run(DeviceSolution& out) {
    if (auto started = session_.run({.restart = true}); !started) return fail(started.error());
    if (rule_.max_bounces == 0) return look_at_start(out);
    ProgressWatch watch;
    while (out.solution.bounces < rule_.max_bounces) {
      const std::uint32_t count = std::min(bounces_per_look(), rule_.max_bounces - out.solution.bounces);
      auto times = session_.run({.bounces = count, .correct = correct_, .residual = true});
      if (!times) return fail(times.error());
      out.seconds.gpu_bounces += times->gpu_seconds;
      out.solution.bounces += count;
      const auto residual = look(out);
      if (!residual) return fail(residual.error());
      book(*residual, contraction_.quotient, out);
      if (options_.observer && !options_.observer(out.solution.bounces, out.solution.error_bound)) {
        return fail(ErrorCode::cancelled,
                    "cancelled after " + std::to_string(out.solution.bounces) + " bounces");
      }
      if (rule_.tolerance <= 0.0) continue;
      if (out.solution.error_bound <= rule_.tolerance) break;
      if (!watch.stalled(out.solution.error_bound)) continue;
      if (!correct_) {
        out.limited_by_rounding = true;
        break;
      }
      out.solution.fallback = "the correction of " + std::to_string(rooms_) +
                              " rooms did not lower the residual any more; plain bounces went on after " +
                              std::to_string(out.solution.bounces) + " products";
      correct_ = false;
      watch = {};
    }
    return read(session_.read_radiosity(), out);
  }

 private:
  /// B0 is the result; one bounce more shows how far it is from the end.
  Result<void> look_at_start(DeviceSolution& out) {
    if (auto bounced = session_.run({.bounces = 1, .residual = true}); !bounced) return fail(bounced.error());
    auto residual = look(out);
    if (!residual) return fail(residual.error());
    if (auto start = read(session_.read_previous_radiosity(), out); !start) return start;
    residual->radiosity = Rgb(0.0);
    for (const Rgb& radiosity : out.solution.radiosity) {
      residual->radiosity = glm::max(residual->radiosity, radiosity);
    }
    book(*residual, Rgb(1.0), out);
    if (auto restarted = session_.run({.restart = true}); !restarted) return fail(restarted.error());
    return {};
  }

  /// A look costs a wait, so small bounces share one.
  std::uint32_t bounces_per_look() const {
    if (correct_ && rule_.tolerance > 0.0) return 1;
    const std::uint64_t most = rule_.tolerance > 0.0 ? 8 : 64;
    const std::uint64_t cost = std::max<std::uint64_t>(session_.bounce_cost(), 1);
    return static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(options_.max_submit_form_factors / cost, 1, most));
  }

  Result<Residual> look(const DeviceSolution& out) {
    auto residual = session_.residual();
    if (residual && !finite(*residual)) {
      return fail(ErrorCode::check_failed, "the radiosity on the device is not finite after " +
                                               std::to_string(out.solution.bounces) + " bounces");
    }
    return residual;
  }

  /// Residual and bounds; `first` is the share of the change that the next bounce can make (as in the
  /// reference).
  void book(const Residual& residual, const Rgb& first, DeviceSolution& out) const {
    const Rgb gap = 1.0 - contraction_.quotient;
    out.solution.relative_residual =
        worst_ratio(Rgb(largest(residual.change)), Rgb(largest(residual.radiosity)));
    out.solution.error_bound = worst_ratio(first * residual.weighted_change / gap, residual.radiosity);
    out.rounding_bound = worst_ratio(rounding_ * residual.weighted_radiosity / gap, residual.radiosity);
  }

  static Result<void> read(Result<std::vector<Rgb>> radiosity, DeviceSolution& out) {
    if (!radiosity) return fail(radiosity.error());
    out.solution.radiosity = std::move(*radiosity);
    return {};
  }

  SolverSession& session_;
  const ContractionBound& contraction_;
  double rounding_;
  const StopRule& rule_;
  const DeviceSolveOptions& options_;
  std::uint32_t rooms_;
  bool correct_;
};

bool has_tiles(const Model& model) {
  const auto in_tiles = [](const BlockMatrix& matrix) {
    return !matrix.blocks.empty() && matrix.blocks[0].tile_rows == kernels::kTileOfRows;
  };
  return std::any_of(model.systems.begin(), model.systems.end(), [&](const System& system) {
    return in_tiles(system.bounce) || in_tiles(system.gather);
  });
}

Result<void> gather(SolverSession& session, DeviceSolution& out) {
  Stopwatch watch;
  const auto times = session.run({.gather = true});
  if (!times) return fail(times.error());
  out.seconds.gather = watch.lap();
  out.seconds.gpu_gather = times->gpu_seconds;
  auto irradiance = session.read_irradiance();
  if (!irradiance) return fail(irradiance.error());
  out.irradiance = std::move(*irradiance);
  auto moments = session.read_directional_irradiance();
  if (!moments) return fail(moments.error());
  out.moments = std::move(*moments);
  auto probes = session.read_probes();
  if (!probes) return fail(probes.error());
  out.probes = std::move(*probes);
  out.seconds.download = watch.lap();
  return {};
}

/// Weights and quotients from products on the device. Both round: the product as a bounce does, v to 32 bits.
Result<ContractionBound> bound_on_device(SolverSession& session, const Lighting& lighting, double rounding) {
  const std::vector<Rgb> black(lighting.albedo.size(), Rgb(0.0));
  const std::vector<Rgb> black_sky(lighting.sky_radiosity.size(), Rgb(0.0));
  const Lighting unlit{lighting.albedo, black, black, black_sky};
  if (auto lit = session.light(unlit, {}); !lit) return fail(lit.error());
  const auto multiply = [&session](const std::vector<Rgb>& v) { return session.multiply(v); };
  auto bound = contraction_bound(multiply, lighting.albedo, rounding + 0x1p-24);
  if (!bound) return bound;
  if (auto checked = check_contraction(*bound); !checked) return fail(checked.error());
  return bound;
}

double predicted_bounces(const ContractionBound& contraction, const StopRule& rule) {
  const double q = largest(contraction.quotient);
  if (rule.tolerance <= 0.0) return 0.0;
  return q <= 0.0 ? 1.0 : std::ceil(std::log(std::min(rule.tolerance, 0.5)) / std::log(q));
}

bool by_products(Method method) {
  return method == Method::bicgstab || method == Method::two_level_gmres;
}

Result<DeviceMethod> choose_method(SolverSession& session, const Model& model,
                                   const DeviceSolveOptions& options, const StopRule& rule, double bounces) {
  const bool any = options.choose_method && rule.max_bounces > 0;
  DeviceMethod chosen = any ? options.choose_method(bounces) : DeviceMethod{};
  const bool corrects = chosen.method == Method::two_level;
  if (!corrects && chosen.method != Method::bounces && !by_products(chosen.method)) {
    return fail(ErrorCode::usage,
                "a device does not solve by " + method_names()[static_cast<std::size_t>(chosen.method)]);
  }
  if (corrects && chosen.rooms.rooms.count == 0) return DeviceMethod{};
  if (!corrects) return chosen;
  if (auto loaded = session.correct_by(model, chosen.rooms); !loaded) return fail(loaded.error());
  return chosen;
}

Result<void> solve_by_products(SolverSession& session, const Model& model, const Lighting& lighting,
                               const ContractionBound& contraction, const DeviceMethod& method,
                               const StopRule& rule, const DeviceSolveOptions& options, DeviceSolution& out) {
  const double rounding = rounding_of_bounce(model);
  const NearAndFar* levels = method.method == Method::bicgstab ? nullptr : &method.near_and_far;
  auto solved =
      solve_by_products(session, model, lighting, contraction, rounding, levels, rule, options.observer);
  if (!solved) return fail(solved.error());
  out.solution = std::move(*solved);
  out.limited_by_rounding = rule.tolerance > 0.0 && out.solution.error_bound > rule.tolerance &&
                            out.solution.bounces < rule.max_bounces;
  const std::vector<Rgb>& radiosity = out.solution.radiosity;
  Rgb top(0.0), weighted(0.0);
  for (std::size_t i = 0; i < radiosity.size(); ++i) {
    top = glm::max(top, radiosity[i]);
    weighted = glm::max(weighted, radiosity[i] / contraction.weights[i]);
  }
  out.rounding_bound = worst_ratio(rounding * weighted / (1.0 - contraction.quotient), top);
  return {};
}

}  // namespace

RowKernel default_row_kernel(const StandaloneDevice& device, const Model& model) {
  if (has_tiles(model)) return default_tile_kernel(device.host());
  const bool processor = device.type() == VK_PHYSICAL_DEVICE_TYPE_CPU;
  return processor ? RowKernel::row_per_thread : RowKernel::row_per_8_lanes;
}

Result<DeviceSolution> solve_on_device(StandaloneDevice& device, const Model& model, const Lighting& lighting,
                                       const StopRule& rule, const DeviceSolveOptions& options) {
  if (auto checked = check_lighting(model, lighting); !checked) return fail(checked.error());
  DeviceSolution out;
  Stopwatch watch;
  const RowKernel kernel = options.kernel.value_or(default_row_kernel(device, model));
  auto session =
      SolverSession::create(device, model, {kernel, options.max_dispatch_form_factors, options.fetch},
                            {options.max_submit_form_factors, options.timeout_seconds});
  if (!session) return fail(session.error());
  out.device = device.name();
  out.kernel = row_kernel_name(kernel);
  out.device_bytes = session->device_bytes();
  out.seconds.upload = session->upload_seconds();
  out.seconds.create = watch.lap() - out.seconds.upload;

  const double rounding = rounding_of_bounce(model);
  const auto contraction = bound_on_device(*session, lighting, rounding);
  if (!contraction) return fail(contraction.error());
  out.seconds.contraction = watch.lap();

  out.predicted_bounces = predicted_bounces(*contraction, rule);
  const auto method = choose_method(*session, model, options, rule, out.predicted_bounces);
  if (!method) return fail(method.error());
  out.method = method->method;
  out.seconds.rooms = watch.lap();

  if (by_products(out.method)) {
    auto solved = solve_by_products(*session, model, lighting, *contraction, *method, rule, options, out);
    if (!solved) return fail(solved.error());
  } else {
    if (auto lit = session->light(lighting, contraction->weights); !lit) return fail(lit.error());
    BounceLoop loop(*session, *contraction, rounding, rule, options, method->rooms.rooms.count);
    if (auto bounced = loop.run(out); !bounced) return fail(bounced.error());
  }
  out.seconds.bounces = watch.lap();
  if (auto gathered = gather(*session, out); !gathered) return fail(gathered.error());
  return out;
}

}  // namespace relume
