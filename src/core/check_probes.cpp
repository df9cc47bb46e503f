// SPDX-License-Identifier: MIT
#include "core/model_checks.h"
#include "core/quantities.h"

namespace relume {
namespace {

// Sums of 32-bit numbers.
constexpr double kRounding = 1e-4;

Result<void> check_sender_list(const System& system, const Probe& probe, const std::string& owner) {
  double sum = 0.0;
  std::uint32_t last_column = 0;
  for (std::uint32_t k = probe.first_sender; k < probe.first_sender + probe.sender_count; ++k) {
    const ProbeSender& sender = system.probe_senders[k];
    if (sender.column >= system.imports.size() || sender.column < last_column) {
      return broken_model("{}: expected ascending columns below {}, found {} after {}", owner,
                          system.imports.size(), sender.column, last_column);
    }
    last_column = sender.column;
    const bool direction =
        finite(sender.direction) && glm::length(glm::dvec3(sender.direction)) <= 1.0 + kRounding;
    if (!direction || !std::isfinite(sender.solid_angle) || !(sender.solid_angle > 0.0f)) {
      return broken_model("{}: expected solid angles above 0 and mean directions of length 1 at most", owner);
    }
    sum += double(sender.solid_angle);
  }
  if (sum <= 4.0 * kPi * (1.0 + kRounding)) return {};
  return broken_model("{}: expected solid angles that add up to 4 pi at most, found {}", owner, sum);
}

}  // namespace

Result<void> check_probes(const Model& model, std::size_t index) {
  const System& system = model.systems[index];
  std::uint64_t next_sender = 0;
  for (std::size_t p = 0; p < system.probes.size(); ++p) {
    const Probe& probe = system.probes[p];
    const std::string owner = fmt::format("system {}, probe {}", index, p);
    if (!finite(probe.position) || probe.name >= model.probe_names.size() ||
        (probe.flags & ~std::uint32_t{kProbeInvalid}) != 0) {
      return broken_model("{}: expected a finite position, a name below {} and known flags", owner,
                          model.probe_names.size());
    }
    const std::uint64_t end = std::uint64_t{probe.first_sender} + probe.sender_count;
    if (probe.first_sender != next_sender || end > system.probe_senders.size()) {
      return broken_model("{}: expected senders from {} on, found {} from {} on of {}", owner, next_sender,
                          probe.sender_count, probe.first_sender, system.probe_senders.size());
    }
    if (auto checked = check_sender_list(system, probe, owner); !checked) return checked;
    next_sender = end;
  }
  if (next_sender == system.probe_senders.size()) return {};
  return broken_model("system {}: expected {} senders of probes, as they say, found {}", index, next_sender,
                      system.probe_senders.size());
}

}  // namespace relume
