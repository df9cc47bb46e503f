// SPDX-License-Identifier: MIT
//
// What was measured, as charts and as tables.
#pragma once

#include <string>
#include <vector>

#include "tool/chart/chart_data.h"
#include "tool/chart/picture.h"

namespace relume {

/// A chart and its numbers as CSV, header first.
struct ChartAndTable {
  ChartPicture chart;
  std::string csv;
};

/// relight, tracking, precompute, products, causes, bytes.
std::vector<ChartAndTable> make_charts(const ChartData& data);

/// Of a relighting: "budget 64".
std::string name_of(const RelightPoint& point);

/// Relightings of the device that no other beats in both time and error, by ascending time.
std::vector<RelightPoint> front_of(const ChartData& data);

}  // namespace relume
