// SPDX-License-Identifier: MIT
//
// glTF 2.0 as a table: the JSON type, range or reference of every property that Relume or tinygltf reads.
// tinygltf 2.7 skips what has the wrong type and believes every index, so nothing reaches it before this
// table has been checked.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/result.h"

namespace relume {

/// The first property of `document` that breaks a rule, as an error with its JSON path.
Result<void> check_rules(const nlohmann::json& document, const std::string& file);

}  // namespace relume
