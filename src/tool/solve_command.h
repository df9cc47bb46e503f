// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "core/solve.h"
#include "tool/console.h"
#include "tool/lighting_setup.h"
#include "tool/solver.h"

namespace relume {

struct SolveArguments {
  std::filesystem::path file;
  std::filesystem::path output;
  LightingOptions lighting;
  SolverChoice solver;
  StopRule rule;
};

/// `relume solve`: relights a model and writes lightmaps, tables and pictures.
Result<int> run(const SolveArguments& arguments, Console& console);

}  // namespace relume
