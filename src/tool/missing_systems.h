// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/missing_share.h"
#include "tool/solver.h"

namespace relume {

/// What the systems that were not loaded may add to the result, see core/missing_share.h. Over the lumels and
/// sensors of the loaded ones.
struct MissingSystems {
  std::vector<std::string> names;  ///< of the systems that are not loaded
  double largest_share = 0.0;      ///< of the hemisphere of a row
  double mean_share = 0.0;
  Rgb assumed_radiosity{0.0};   ///< lm/m2, the most that any of their surfaces is taken to have
  Rgb largest_irradiance{0.0};  ///< lux, the most that a row can lack under that assumption
  Rgb mean_irradiance{0.0};     ///< lux, the mean of what rows can lack
};

/// Nothing when all systems are loaded. Without `assumed_radiosity` it is the largest of `outcome`, per
/// channel. Solves once more, for the missing light; what its bounces left open is added.
Result<std::optional<MissingSystems>> bound_missing_light(const Model& model, const Lighting& lighting,
                                                          const SolveOutcome& outcome,
                                                          const std::optional<double>& assumed_radiosity,
                                                          const StopRule& rule, const SolverChoice& choice,
                                                          Console& console);

/// One sentence for people; `given`: whether the radiosity was asked for.
std::string missing_sentence(const MissingSystems& missing, std::size_t systems, bool given);

/// The object `missing_systems` of `solve --json`, null without.
JsonValue missing_json(const std::optional<MissingSystems>& missing);

}  // namespace relume
