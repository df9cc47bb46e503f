// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "compute/lightmap_format.h"
#include "core/bracket.h"
#include "core/model.h"
#include "tool/console.h"
#include "tool/lighting_setup.h"
#include "tool/output_folder.h"
#include "tool/solver.h"

namespace relume {

/// Makes everything that `relume solve` leaves behind: lightmaps/SYSTEM.direct.exr and .indirect.exr,
/// and, where the model has directions, .directional.exr (red, green, blue: dominant_direction() along x, y,
/// z), lightmaps.json, clusters.csv, sensors.csv, probes.csv and probes.exr where there are probes,
/// result.glb, preview.png. With `ktx2`, lightmaps are written as .ktx2 in this format as well, directions in
/// one with signs. With `bracket` (null: without), tables have its columns, and lightmaps/SYSTEM.low.exr and
/// .high.exr bound the indirect ones; SYSTEM.width.png shows (high - low) / value as heat_color(). Warns of
/// values that half precision cannot hold.
Result<void> make_solve_outputs(const Model& model, const LightingSetup& setup, const SolveOutcome& outcome,
                                const SolutionBracket* bracket, std::optional<LightmapFormat> ktx2,
                                OutputFolder& folder, Console& console);

}  // namespace relume
