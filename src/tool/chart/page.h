// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "tool/chart/charts.h"
#include "tool/chart/run_facts.h"

namespace relume {

/// One page of HTML with all charts in it; it loads nothing. Values show where a pointer rests.
std::string chart_page(const std::string& title, const std::vector<ChartAndTable>& charts, const Facts& facts,
                       const std::vector<std::string>& notes);

}  // namespace relume
