// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "core/light.h"
#include "core/result.h"

namespace relume {

/// Reads `--lights`: {"lights":[{"type":"point|spot|directional", "color":[r,g,b], "intensity": cd or lx,
/// "position":[x,y,z], "direction":[x,y,z], "range", "innerConeAngle", "outerConeAngle", "name"}]}, world
/// space, angles in radians. Defaults are those of KHR_lights_punctual; a position (point, spot) and a
/// direction (spot, directional) are required. bad_input names file and JSON path.
Result<std::vector<Light>> read_lights(const std::filesystem::path& file);

}  // namespace relume
