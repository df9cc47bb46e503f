// SPDX-License-Identifier: MIT
//
// Direct irradiance by the device that solves.
#pragma once

#include <string>

#include "tool/console.h"
#include "tool/lighting_setup.h"

namespace relume {

inline constexpr const char* kProcessor = "processor";

/// By the Vulkan device whose name has `device_name` in it; no_device when there is none.
Result<DirectIrradiance> direct_by_vulkan(const Model& model, std::span<const Light> lights,
                                          const std::string& device_name);

/// What `solve --device vulkan` uses: what the device computed, or, with a warning, the processor where the
/// device has no room for the model's occluders. `computed_by` becomes the name of the device or kProcessor.
/// Both must outlive the source.
DirectLightSource direct_light_of_device(const std::string& device_name, Console& console,
                                         std::string& computed_by);

/// `by_device`, unless it failed for lack of room (no_device or out_of_memory: the device itself was found):
/// then the processor's, with a warning that says why.
Result<DirectIrradiance> or_by_processor(Result<DirectIrradiance> by_device, const Model& model,
                                         std::span<const Light> lights, Console& console,
                                         std::string& computed_by);

}  // namespace relume
