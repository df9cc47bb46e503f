// SPDX-License-Identifier: MIT
#include "compute/schedule.h"

#include <algorithm>
#include <glm/common.hpp>
#include <utility>

namespace relume {
namespace {

double share_of(const CouplingRow& row, std::uint32_t system) {
  const auto found = std::lower_bound(row.shares.begin(), row.shares.end(), system,
                                      [](const Coupling& c, std::uint32_t s) { return c.system < s; });
  return found != row.shares.end() && found->system == system ? found->share : 0.0;
}

/// delta = d + F(delta), from above: max d / (1 - q) everywhere bounds it, and so does each step from there.
/// Nothing that is off is off by more than `most`.
std::vector<double> moved_solution(std::span<const SystemTraits> traits, const Schedule& schedule,
                                   const std::vector<double>& d, double most) {
  constexpr int kSteps = 16;
  const double quotient = contraction_quotient(traits, schedule);
  const double largest = d.empty() ? 0.0 : *std::max_element(d.begin(), d.end());
  const double everywhere = quotient < 1.0 ? std::min(largest / (1.0 - quotient), most) : most;
  std::vector<double> delta(d.size(), 0.0);
  for (std::size_t s = 0; s < d.size(); ++s) {
    if (schedule.systems[s].active) delta[s] = everywhere;
  }
  for (int k = 0; k < kSteps; ++k) {
    std::vector<double> next = delta;
    for (std::size_t s = 0; s < d.size(); ++s) {
      if (schedule.systems[s].active) next[s] = std::min(delta[s], d[s] + arriving(traits[s].bounce, delta));
    }
    delta = std::move(next);
  }
  return delta;
}

/// M + rho H and what arrives from the sky change by at most `d`, what gathers see of the sky by `seen`.
void move_solution(std::span<const SystemTraits> traits, Schedule& schedule, const std::vector<double>& d,
                   const std::vector<double>& seen) {
  const double most = schedule.largest_radiosity;
  const std::vector<double> delta = moved_solution(traits, schedule, d, most);
  for (std::size_t s = 0; s < delta.size(); ++s) {
    SystemProgress& system = schedule.systems[s];
    if (!system.active) continue;
    const double shown = seen[s] + arriving(traits[s].gather, delta);
    system.error = std::min(system.error + delta[s], most);
    system.next_error = std::min(system.next_error + delta[s], most);
    system.output_error = std::min(system.output_error + shown, most);
    system.next_output_error = std::min(system.next_output_error + shown, most);
  }
}

/// Something that sends shines up to `change` more or less.
void note_sender(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t sender,
                 double change) {
  std::vector<double> d(schedule.systems.size(), 0.0), seen(schedule.systems.size(), 0.0);
  for (std::size_t t = 0; t < d.size(); ++t) {
    if (!schedule.systems[t].active) continue;
    d[t] = share_of(traits[t].bounce, sender) * change;
    seen[t] = share_of(traits[t].gather, sender) * change;
  }
  move_solution(traits, schedule, d, seen);
}

double largest(const Rgb& value) {
  return std::max({value.x, value.y, value.z});
}

}  // namespace

double arriving(const CouplingRow& row, std::span<const double> of_system) {
  double sum = 0.0, most = 0.0;
  for (const Coupling& c : row.shares) {
    if (c.system >= of_system.size()) continue;
    sum += c.share * of_system[c.system];
    most = std::max(most, of_system[c.system]);
  }
  return std::min(sum, row.total * most);
}

Schedule make_schedule(std::size_t systems, double largest_radiosity) {
  return {std::vector<SystemProgress>(systems), {}, largest_radiosity};
}

void activate(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system) {
  const double most = schedule.largest_radiosity;
  note_sender(traits, schedule, system, most);
  schedule.systems[system] = {};
  schedule.systems[system].active = true;
  schedule.systems[system].error = most;
  schedule.systems[system].output_error = most;
}

void deactivate(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system) {
  const std::vector<std::uint32_t>& members = schedule.pass.systems;
  if (std::find(members.begin(), members.end(), system) != members.end()) schedule.pass = {};
  schedule.systems[system] = {};
  note_sender(traits, schedule, system, schedule.largest_radiosity);
}

void note_change(std::span<const SystemTraits> traits, Schedule& schedule, std::uint32_t system,
                 double change) {
  if (change <= 0.0) return;
  if (system == schedule.systems.size()) {
    note_sender(traits, schedule, system, change);
    return;
  }
  std::vector<double> d(schedule.systems.size(), 0.0);
  d[system] = change;
  move_solution(traits, schedule, d, std::vector<double>(d.size(), 0.0));
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

std::vector<double> radiosity_errors(const Schedule& schedule) {
  std::vector<double> errors;
  for (const SystemProgress& system : schedule.systems) errors.push_back(system.active ? system.error : 0.0);
  return errors;
}

}  // namespace relume
