// SPDX-License-Identifier: MIT
#include "compute/direct_light_options.h"

#include <string>

#include "core/light_patches.h"

namespace relume {

std::vector<std::uint32_t> chosen_systems(const Model& model, const DirectLightOptions& options) {
  if (!options.systems.empty()) return options.systems;
  std::vector<std::uint32_t> all;
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    if (model.systems[s].loaded) all.push_back(s);
  }
  return all;
}

Result<void> check_light_options(const Model& model, const DirectLightOptions& options) {
  if (options.max_lights == 0) return fail(ErrorCode::usage, "direct light: max_lights must not be 0");
  if (!(options.patches_per_element > 0.0 && options.patches_per_element <= kPatchesPerElement)) {
    return fail(ErrorCode::usage, "direct light: expected patches_per_element above 0, at most " +
                                      std::to_string(kPatchesPerElement) + ", found " +
                                      std::to_string(options.patches_per_element));
  }
  for (const std::uint32_t system : options.systems) {
    if (system < model.systems.size() && model.systems[system].loaded) continue;
    return fail(ErrorCode::usage, "direct light: expected loaded systems below " +
                                      std::to_string(model.systems.size()) + ", found " +
                                      std::to_string(system));
  }
  return {};
}

}  // namespace relume
