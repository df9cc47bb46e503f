// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "compute/lightmap_format.h"
#include "core/bracket.h"
#include "core/model.h"
#include "core/ray_noise.h"
#include "tool/console.h"
#include "tool/lighting_setup.h"
#include "tool/output_folder.h"
#include "tool/solver.h"

namespace relume {

/// What is written of how far the answer may be off; null: nothing.
struct ToldErrors {
  const SolutionBracket* bracket = nullptr;
  const RayNoise* noise = nullptr;
};

/// Makes everything that `relume solve` leaves behind: lightmaps/SYSTEM.direct.exr and .indirect.exr,
/// and, where the model has directions, .directional.exr (red, green, blue: dominant_direction() along x, y,
/// z), lightmaps.json, clusters.csv, sensors.csv, probes.csv and probes.exr where there are probes,
/// result.glb, preview.png. With `ktx2`, lightmaps are written as .ktx2 in this format as well, directions in
/// one with signs. With `told.bracket` (null: without), tables have its columns, and
/// lightmaps/SYSTEM.low.exr and .high.exr bound the indirect ones; SYSTEM.width.png shows (high - low) /
/// value as heat_color(). With `told.noise`, SYSTEM.noise.exr is the standard error of the indirect one, and
/// clusters.csv has that of the radiosity. Warns of values that half precision cannot hold.
Result<void> make_solve_outputs(const Model& model, const LightingSetup& setup, const SolveOutcome& outcome,
                                const ToldErrors& told, std::optional<LightmapFormat> ktx2,
                                OutputFolder& folder, Console& console);

}  // namespace relume
