// SPDX-License-Identifier: MIT
//
// What an answer may be off by, cause by cause (`solve --bounds`): each a share of the root mean square of
// indirect irradiance over the lumels.
#pragma once

#include <optional>
#include <string>

#include "core/ray_noise.h"
#include "tool/lighting_setup.h"
#include "tool/solver.h"

namespace relume {

struct NamedErrors {
  std::optional<double> clusters;  ///< their size, for the lights that shine (cluster_refinement.h)
  /// Estimated by the precompute for lights that it had not seen; absent where it had no error target.
  std::optional<double> cut;
  std::optional<double> rays;     ///< of `noise`; absent without light
  std::optional<RayNoise> noise;  ///< standard errors for the lights that shine
  double precision = 0.0;         ///< of stored values, at most, at an albedo of 0.8
  std::optional<double> light;  ///< what a quarter of the shadow samples would change; absent without lights
  double iteration = 0.0;       ///< bound, relative to the largest radiosity
};

/// Of what `outcome` solved.
Result<NamedErrors> name_errors(const Model& model, const LightingSetup& setup, const SolveOutcome& outcome);

/// One sentence for people.
std::string errors_sentence(const NamedErrors& errors);

/// The object `errors` of `solve --json`.
JsonValue errors_json(const NamedErrors& errors);

/// What a file says of its errors, whatever the lights: a line for people, and the object `errors` of
/// `info --json`.
std::string stored_errors_line(const Model& model);
JsonValue stored_errors_json(const Model& model);

}  // namespace relume
