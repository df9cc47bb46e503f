// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

#include "scene/scene.h"
#include "tool/chart/chart_data.h"
#include "tool/chart/chart_plan.h"

namespace relume {

/// Measures all charts of a scene on the Vulkan device with `device_name` in its name. `show` gets the share
/// of the work that is done. Fails with no_device without one, with check_failed when it gives wrong answers.
Result<ChartData> measure_charts(Scene scene, const ChartPlan& plan, const std::string& device_name,
                                 const std::function<void(double)>& show);

}  // namespace relume
