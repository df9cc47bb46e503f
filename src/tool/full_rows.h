// SPDX-License-Identifier: MIT
//
// Rows with all that their rays found, from what a precompute kept of its rays (precompute/rows_file.h).
#pragma once

#include <filesystem>
#include <optional>

#include "core/model.h"
#include "core/result.h"
#include "tool/console.h"

namespace relume {

/// What the precompute of `model` would have made of the rays in the file `rows` without a budget, in f32:
/// the same surfaces and sensors, no probes. The scene is looked for beside `rows`, by the name that the
/// model knows; else it is `scene`. Fails (bad_input) where there is none, or as PrecomputeOptions::old_rows
/// says.
Result<Model> full_rows(const std::filesystem::path& rows, const Model& model,
                        const std::optional<std::filesystem::path>& scene, Console& console);

}  // namespace relume
