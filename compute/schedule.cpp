// SPDX-License-Identifier: MIT
#include "compute/schedule.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <utility>

namespace relume {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

double share_of(const CouplingRow& row, std::uint32_t system) {
  const auto found = std::lower_bound(row.shares.begin(), row.shares.end(), system,
                                      [](const Coupling& c, std::uint32_t s) { return c.system < s; });
  return found != row.shares.end() && found->system == system ? found->share : 0.0;
}

double arriving(const CouplingRow& row, const std::vector<double>& of_system) {
  double sum = 0.0, most = 0.0;
  for (const Coupling& c : row.shares) {
    if (c.system >= of_system.size() || of_system[c.system] <= 0.0) continue;
    sum += c.share * of_system[c.system];
    most = std::max(most, of_system[c.system]);
  }
  return std::min(sum, row.total * most);
}

/// p of every system, and of what bounces that are not complete took in.
std::vector<double> residual_bounds(std::span<const SystemTraits> traits, const Schedule& schedule) {
  std::vector<double> bounds(schedule.systems.size(), 0.0);
  for (std::size_t s = 0; s < bounds.size(); ++s) {
    const SystemProgress& system = schedule.systems[s];
    if (system.active) bounds[s] = exposure_bound(traits[s].bounce, system.pending) + system.taken;
  }
  return bounds;
}

/// What a pass took in and did not finish is pending again.
void give_up_pass(Schedule& schedule) {
  for (SystemProgress& system : schedule.systems) {
    system.pending.own += std::exchange(system.taken, 0.0);
    system.stale.own += std::exchange(system.gathering, 0.0);
  }
  schedule.pass = {};
}

double largest(const Rgb& value) {
  return std::max({value.x, value.y, value.z});
}

}  // namespace

double exposure_bound(const CouplingRow& row, const Exposure& exposure) {
  return exposure.own + arriving(row, exposure.seen);
}

void note_radiosity_change(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system,
                           double change) {
  if (change <= 0.0) return;
  for (std::uint32_t t = 0; t < schedule.systems.size(); ++t) {
    SystemProgress& progress = schedule.systems[t];
    if (!progress.active) continue;
    if (system == schedule.systems.size()) {
      progress.pending.own += share_of(traits[t].bounce, system) * change;
      progress.stale.own += share_of(traits[t].gather, system) * change;
    } else {
      progress.pending.seen[system] += change;
      progress.stale.seen[system] += change;
    }
  }
}

Schedule make_schedule(std::size_t systems) {
  return {std::vector<SystemProgress>(systems), {}};
}

void activate(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system,
              double largest_radiosity) {
  SystemProgress& progress = schedule.systems[system];
  progress = {};
  note_radiosity_change(traits, schedule, system, largest_radiosity);
  progress.active = true;
  progress.pending = {largest_radiosity, std::vector<double>(schedule.systems.size(), 0.0)};
  progress.stale = progress.pending;
}

void deactivate(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system,
                double largest_radiosity) {
  const std::vector<std::uint32_t>& members = schedule.pass.systems;
  if (std::find(members.begin(), members.end(), system) != members.end()) give_up_pass(schedule);
  schedule.systems[system] = {};
  note_radiosity_change(traits, schedule, system, largest_radiosity);
}

void note_change(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system,
                 double change) {
  if (system == schedule.systems.size()) {
    note_radiosity_change(traits, schedule, system, change);
  } else if (change > 0.0) {
    schedule.systems[system].pending.own += change;
  }
}

double lighting_change(const Lighting& before, const Lighting& after, std::size_t first, std::size_t count,
                       double largest_irradiance) {
  double change = 0.0;
  for (std::size_t i = first; i < first + count; ++i) {
    const Rgb source = after.exitance[i] + after.albedo[i] * after.direct[i] - before.exitance[i] -
                       before.albedo[i] * before.direct[i];
    const Rgb reflected = (after.albedo[i] - before.albedo[i]) * largest_irradiance;
    change = std::max(change, largest(glm::abs(source) + glm::abs(reflected)));
  }
  return change;
}

double contraction_quotient(std::span<const SystemTraits> traits, const Schedule& schedule) {
  double quotient = 0.0;
  for (std::size_t s = 0; s < schedule.systems.size(); ++s) {
    if (schedule.systems[s].active) quotient = std::max(quotient, traits[s].bounce.total);
  }
  return quotient;
}

// Starting from max p / (1 - q) everywhere, which is a bound, e <- p + min(C e, q max e) only gives better
// ones.
std::vector<double> radiosity_errors(std::span<const SystemTraits> traits, const Schedule& schedule) {
  constexpr int kIterations = 16;
  const std::vector<double> residuals = residual_bounds(traits, schedule);
  const double quotient = contraction_quotient(traits, schedule);
  double largest_residual = 0.0;
  for (const double residual : residuals) largest_residual = std::max(largest_residual, residual);
  std::vector<double> errors(residuals.size(), 0.0);
  for (std::size_t s = 0; s < errors.size(); ++s) {
    if (!schedule.systems[s].active) continue;
    if (quotient < 1.0) {
      errors[s] = largest_residual / (1.0 - quotient);
    } else if (largest_residual > 0.0) {
      errors[s] = kInfinite;
    }
  }
  if (quotient >= 1.0) return errors;
  for (int k = 0; k < kIterations; ++k) {
    std::vector<double> next = residuals;
    for (std::size_t s = 0; s < next.size(); ++s) {
      if (schedule.systems[s].active) next[s] += arriving(traits[s].bounce, errors);
    }
    errors = std::move(next);
  }
  return errors;
}

std::vector<double> output_errors(std::span<const SystemTraits> traits, const Schedule& schedule) {
  const std::vector<double> errors = radiosity_errors(traits, schedule);
  std::vector<double> outputs(errors.size(), 0.0);
  for (std::size_t s = 0; s < outputs.size(); ++s) {
    const SystemProgress& system = schedule.systems[s];
    if (!system.active) continue;
    outputs[s] =
        exposure_bound(traits[s].gather, system.stale) + system.gathering + arriving(traits[s].gather, errors);
  }
  return outputs;
}

}  // namespace relume
