// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "tool/console.h"
#include "tool/lighting_setup.h"
#include "tool/solver.h"

namespace relume {

struct CompareArguments {
  std::filesystem::path file;
  LightingOptions lighting;
  SolverChoice solver;                   ///< of the Vulkan side
  std::optional<std::uint32_t> bounces;  ///< absent: as many as the reference needs for 1e-5
  double tolerance = 1e-5;               ///< largest relative error that passes
};

/// `relume compare`: GPU against the reference on the same matrices, direct irradiance and number of bounces.
/// Exit status 1 above the tolerance.
Result<int> run(const CompareArguments& arguments, Console& console);

}  // namespace relume
