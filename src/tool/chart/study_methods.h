// SPDX-License-Identifier: MIT
//
// Every method of the reference (core/methods/methods.h): time on the centre, and products against albedo.
#pragma once

#include "tool/chart/study_models.h"

namespace relume {

/// A whole relighting of the centre by each method on one core, in double precision. Those that refuse or
/// give way there become notes of `data`.
Result<std::vector<RelightPoint>> time_methods(const ChartTest& test, const ModelStudy& study,
                                               ChartData& data);

/// Products until reflected light is within kConverged of the solution (relative L2 over clusters, weighted
/// by area), all surfaces of one albedo, on full rows between few clusters.
Result<void> count_products(const ChartPlan& plan, const ChartTest& test, ChartProgress& progress,
                            ChartData& data);

/// Of all steps of count_products, for progress.
double guessed_seconds_of_products(const ChartPlan& plan);

}  // namespace relume
