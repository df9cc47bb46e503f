// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "compute/lightmap_format.h"
#include "core/solve.h"
#include "tool/console.h"
#include "tool/lighting_setup.h"
#include "tool/solver.h"

namespace relume {

struct SolveArguments {
  std::filesystem::path file;
  std::filesystem::path output;
  std::vector<std::string> systems;         ///< the only ones to load; empty: all
  std::optional<double> missing_radiosity;  ///< lm/m2, the most that a surface of the others has
  bool bounds = false;                      ///< also between which values the answer of the full rows lies
  std::filesystem::path certify;            ///< a file of full rows, or of rays; empty: none
  std::optional<LightmapFormat> ktx2;       ///< lightmaps as .ktx2 as well
  LightingOptions lighting;
  SolverChoice solver;
  StopRule rule;
};

/// `relume solve`: relights a model and writes lightmaps, tables and pictures.
Result<int> run(const SolveArguments& arguments, Console& console);

}  // namespace relume
