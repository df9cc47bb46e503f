// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/import/container.h"
#include "scene/load_scene.h"

namespace relume {

/// Parses the JSON of a container and checks all that can be checked without reading data: depth, rules,
/// version, extensions, ranges and node forest. Warnings are appended.
Result<nlohmann::json> parse_document(const GltfContainer& container, const SceneLimits& limits,
                                      const std::string& file, std::vector<std::string>& warnings);

}  // namespace relume
