// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "scene/scene.h"
#include "tool/chart/chart_data.h"
#include "tool/chart/chart_plan.h"

namespace relume {

/// Measures all charts of a scene. `show` gets the share of the work that is done. Fails with no_device
/// without a Vulkan device, with check_failed when one gives wrong answers.
Result<ChartData> measure_charts(Scene scene, const ChartOptions& options,
                                 const std::function<void(double)>& show);

}  // namespace relume
