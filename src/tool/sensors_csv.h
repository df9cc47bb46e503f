// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "core/result.h"
#include "precompute/precompute.h"

namespace relume {

/// Reads `--sensors`: a CSV whose header names at least id,px,py,pz,nx,ny,nz in any order (world space,
/// metres); further columns are ignored, quotes are not supported. Ids are texts and unique, normals are not
/// zero. bad_input names file, line, expected and found.
Result<std::vector<SensorPoint>> read_sensors(const std::filesystem::path& file);

/// The same for `--probes`, of which the header names at least id,px,py,pz.
Result<std::vector<ProbePoint>> read_probes(const std::filesystem::path& file);

}  // namespace relume
