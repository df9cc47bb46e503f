// SPDX-License-Identifier: MIT
#include "core/probe_coefficients.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "core/import_radiosity.h"
#include "core/quantities.h"

namespace relume {
Harmonics mean_harmonics(const glm::dvec3& d) {
  const double y0 = 0.5 / std::sqrt(kPi), y1 = std::sqrt(3.0 / (4.0 * kPi));
  const double squared = glm::dot(d, d), y2 = std::sqrt(15.0 / (4.0 * kPi)) * std::sqrt(squared);
  return {y0,
          y1 * d.y,
          y1 * d.z,
          y1 * d.x,
          y2 * d.x * d.y,
          y2 * d.y * d.z,
          y2 * (3.0 * d.z * d.z - squared) / (2.0 * std::sqrt(3.0)),
          y2 * d.x * d.z,
          y2 * 0.5 * (d.x * d.x - d.y * d.y)};
}

std::vector<ProbeCoefficients> probe_coefficients(const Model& model, const Lighting& lighting,
                                                  const std::vector<Rgb>& radiosity) {
  const LeafNumbers numbers(model);
  const std::vector<Rgb> leaves = leaf_radiosity(lighting, radiosity);
  std::vector<ProbeCoefficients> all(model.probe_names.size(), ProbeCoefficients{});
  for (const System& system : model.systems) {
    if (system.probes.empty()) continue;
    const std::vector<Rgb> imports = import_radiosity(system, numbers, leaves);
    for (const Probe& probe : system.probes) {
      ProbeCoefficients& sums = all[probe.name];
      for (std::uint32_t k = probe.first_sender; k < probe.first_sender + probe.sender_count; ++k) {
        const ProbeSender& sender = system.probe_senders[k];
        const Rgb arriving = double(sender.solid_angle) * radiance_from_radiosity(imports[sender.column]);
        const Harmonics y = mean_harmonics(glm::dvec3(sender.direction));
        for (std::size_t h = 0; h < kProbeHarmonics; ++h) sums[h] += y[h] * arriving;
      }
    }
  }
  return all;
}

Rgb probe_irradiance(std::span<const ProbeCoefficients> probes, const WeightedProbes& at,
                     const glm::dvec3& normal) {
  const Harmonics y = mean_harmonics(normal);
  Rgb sum(0.0);
  for (std::size_t c = 0; c < at.probes.size(); ++c) {
    if (!(at.weights[c] > 0.0f)) continue;
    const ProbeCoefficients& probe = probes[at.probes[c]];
    for (std::size_t h = 0; h < kProbeHarmonics; ++h) {
      const double lobe = h == 0 ? 1.0 : h < 4 ? 2.0 / 3.0 : 0.25;
      sum += double(at.weights[c]) * kPi * lobe * y[h] * probe[h];
    }
  }
  return glm::max(sum, Rgb(0.0));
}

FlatCoefficients flat_coefficients(const std::vector<ProbeCoefficients>& probes) {
  FlatCoefficients flat;
  for (const ProbeCoefficients& probe : probes) {
    flat.values.insert(flat.values.end(), probe.begin(), probe.end());
    flat.magnitudes.insert(flat.magnitudes.end(), probe.size(), probe[0]);
  }
  return flat;
}

}  // namespace relume
