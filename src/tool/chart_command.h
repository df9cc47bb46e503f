// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "tool/chart/chart_plan.h"
#include "tool/console.h"

namespace relume {

struct ChartArguments {
  std::filesystem::path scene;
  std::filesystem::path output;
  ChartOptions options;
};

/// `relume chart`: speed against error, as .csv and .svg per chart and one self-contained chart.html.
Result<int> run(const ChartArguments& arguments, Console& console);

}  // namespace relume
