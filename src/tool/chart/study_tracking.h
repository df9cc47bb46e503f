// SPDX-License-Identifier: MIT
//
// A light on a circle: what k products per frame, from the last frame's radiosity, leave behind.
#pragma once

#include "tool/chart/study_models.h"

namespace relume {

/// On the centre.
Result<std::vector<TrackingPoint>> track_light(const ChartPlan& plan, const ChartTest& test,
                                               ModelStudy& study);

}  // namespace relume
