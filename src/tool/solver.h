// SPDX-License-Identifier: MIT
//
// One face for both solvers: the reference and the Vulkan one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/directional_irradiance.h"
#include "core/methods/methods.h"
#include "core/model.h"
#include "core/probe_coefficients.h"
#include "core/solve.h"
#include "tool/console.h"

namespace relume {

struct SolverChoice {
  bool reference = false;                          ///< else Vulkan
  std::string device_name;                         ///< part of the name of the Vulkan device, empty: any
  std::string kernel;                              ///< empty: the solver's own choice
  std::optional<Method> method = Method::bounces;  ///< nothing: the fastest that is safe for the scene
};

struct SolveOutcome {
  Solution solution;
  std::vector<Rgb> gathered;               ///< irradiance through form factors per gather row, lux
  std::vector<IrradianceMoments> moments;  ///< of `gathered`, where the model is directional
  std::vector<ProbeCoefficients> probes;
  std::string device;  ///< "reference" or the name of the Vulkan device
  std::string kernel;  ///< empty for the reference
  Method method = Method::bounces;
  std::string method_reason;             ///< a sentence without a full stop
  std::optional<ScenePrediction> scene;  ///< where the method was chosen by what was measured
  double rounding_bound = 0.0;  ///< what rounding can do on top of the error bound, relative to max B
  JsonObject seconds;           ///< per stage
};

/// What `--kernel` may name.
const std::vector<std::string>& kernel_names();

/// The radiosity, then the gather. The Vulkan device knows plain bounces: another method is an error (usage).
/// There is no way back to the reference when no device is found: that is an error (no_device).
Result<SolveOutcome> solve(const Model& model, const Lighting& lighting, const StopRule& rule,
                           const SolverChoice& choice, Console& console);

}  // namespace relume
