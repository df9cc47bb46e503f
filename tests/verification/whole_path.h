// SPDX-License-Identifier: MIT
//
// The whole path in one call, as a user goes it: scene, precompute, direct light, solve, gather.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model.h"
#include "core/probe_coefficients.h"
#include "core/sky.h"
#include "core/solve.h"
#include "precompute/precompute.h"
#include "scene/scene.h"

namespace relume::test {

/// What shines: punctual lights and the sky. Emission and albedo come from a scene.
struct LightSources {
  std::vector<Light> lights;
  std::optional<Sky> sky;
};

/// Everything that a solve of `model` needs, with the colours of `scene` (the one precomputed, or an edit).
/// `gather_direct`: punctual irradiance per gather row.
struct RunTimeLighting {
  Lighting lighting;
  std::vector<Rgb> gather_direct;
};
RunTimeLighting light(const Model& model, const Scene& scene, const LightSources& sources);

/// lm/m2 per gather row of all systems.
struct GatheredIrradiance {
  std::vector<Rgb> direct;    ///< from punctual lights, unreflected
  std::vector<Rgb> indirect;  ///< all that comes through form factors
};

/// Reference solve to 1e-6, then the gather. Throws std::runtime_error with the message of a refusal, which
/// fails the test.
GatheredIrradiance solve_and_gather(const Model& model, const RunTimeLighting& lit);

/// The same for the light probes.
std::vector<ProbeCoefficients> solve_probes(const Model& model, const RunTimeLighting& lit);

/// The part of a per-gather-row array that belongs to the sensors, in their order.
std::vector<Rgb> at_sensors(const Model& model, const std::vector<Rgb>& gather_rows);

/// precompute() that throws std::runtime_error with the message of a refusal, and checks the model.
Model precompute_or_throw(const Scene& scene, const PrecomputeOptions& options,
                          PrecomputeReport* report = nullptr);

/// How values compare with a truth, over all entries and channels.
struct Agreement {
  double bias = 0.0;   ///< sum(p - t) / sum(t)
  double nrmse = 0.0;  ///< sqrt(sum (p - t)^2 / sum t^2)
  double worst = 0.0;  ///< max |p - t| / (t + 2 % of the mean t)
  std::size_t worst_index = 0;
};
Agreement agreement(std::span<const Rgb> values, std::span<const Rgb> truth);

}  // namespace relume::test
