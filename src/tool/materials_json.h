// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/model.h"
#include "core/result.h"
#include "core/solve.h"

namespace relume {

/// What `--materials` says of one material; absent = as it was. Final values: textures no longer matter.
struct MaterialOverride {
  std::uint32_t material = 0;  ///< index into Model::materials
  std::optional<Rgb> albedo;
  std::optional<Rgb> emission;  ///< radiance, cd/m2
};

/// Reads {"materials":{NAME:{"albedo":[r,g,b],"emission":[r,g,b]}}}. bad_input names file and JSON path, also
/// for a name that the model does not have.
Result<std::vector<MaterialOverride>> read_material_overrides(const std::filesystem::path& file,
                                                              const Model& model);

/// Puts the overrides into the clusters of `lighting`; albedo is clamped to `max_albedo`. Returns how many
/// overrides were clamped.
std::uint32_t apply_material_overrides(const Model& model, const std::vector<MaterialOverride>& overrides,
                                       double max_albedo, Lighting& lighting);

}  // namespace relume
