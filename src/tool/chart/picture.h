// SPDX-License-Identifier: MIT
//
// A chart as plain values, and its picture as SVG: points by series, told apart by colour (M. Okabe, K. Ito,
// Color Universal Design, 2002) and by shape, so that prints and colour-blind readers lose nothing.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace relume {

struct ChartPoint {
  double x = 0.0;
  double y = 0.0;
  std::string label{};  ///< a word beside the point where there is room for it; may be empty
  std::string hover{};  ///< shown when a pointer rests on it
  bool failed = false;  ///< drawn as a cross, and not joined to its neighbours
  bool chosen = false;  ///< ringed; its label is placed first
};

struct ChartSeries {
  std::string name;
  std::vector<ChartPoint> points;
  bool joined = true;  ///< by a line, in the order of the points
};

struct ChartAxis {
  std::string label;  ///< with its unit
  bool logarithmic = true;
  std::vector<std::pair<double, std::string>> ticks{};  ///< lines of text; empty: round numbers
};

/// A dashed line across.
struct ChartLevel {
  double y = 0.0;
  std::string name;
};

struct ChartPicture {
  std::string name;  ///< of its files: letters, digits and '-'
  std::string title;
  std::string text;  ///< what it shows and how it was measured, for the page
  ChartAxis x, y;
  std::vector<ChartSeries> series;
  std::vector<std::pair<double, double>> front{};  ///< joined by a grey line behind all
  std::optional<ChartLevel> level{};
};

/// An SVG of 960 x 600, UTF-8, without references to anything outside. Points that are not finite, or not
/// above zero on a logarithmic axis, are left out.
std::string to_svg(const ChartPicture& chart);

/// The points that no other beats in both x and y (less is better), by ascending x; failed ones have no part.
std::vector<std::pair<double, double>> pareto_front(const std::vector<ChartSeries>& series);

/// `text` with &, <, > and " replaced, for XML and HTML.
std::string escaped(const std::string& text);

}  // namespace relume
