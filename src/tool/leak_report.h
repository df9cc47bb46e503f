// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/model.h"
#include "precompute/leak_meter.h"
#include "tool/json_value.h"

namespace relume {

/// For people: sums, and the worst rows with their places.
std::vector<std::string> leak_lines(const Model& model, const LeakReport& report);

/// The same as members `lumels`, `clusters`, `worst_walled` and `worst_hidden`.
JsonObject leaks_json(const Model& model, const LeakReport& report);

}  // namespace relume
