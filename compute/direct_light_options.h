// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "compute/direct_light.h"
#include "core/model.h"
#include "core/result.h"

namespace relume {

/// Those that the options name, or else all that are loaded.
std::vector<std::uint32_t> chosen_systems(const Model& model, const DirectLightOptions& options);

/// Fails with usage; the sentence names the option.
Result<void> check_light_options(const Model& model, const DirectLightOptions& options);

}  // namespace relume
