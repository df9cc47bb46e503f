// SPDX-License-Identifier: MIT
#include "tool/chart/axis_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume {
namespace {

/// Room at each end, as a share of what the values span, and the least span.
constexpr double kRoom = 0.05, kLeastSpan = 0.3;
/// Up to so many powers of ten, 2 and 5 get numbers too; up to so many, all digits.
constexpr double kFewDecades = 2.2, kOneDecade = 0.8;

}  // namespace

std::string short_number(double value) {
  return fmt::format("{:.3g}", value);
}

AxisScale::AxisScale(const ChartAxis& axis, const std::vector<double>& values) : axis_(axis) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!shows(value)) continue;
    low = std::min(low, scaled(value)), high = std::max(high, scaled(value));
  }
  if (low > high) low = 0.0, high = 1.0;
  const double missing = std::max(0.0, (axis.logarithmic ? kLeastSpan : 1e-12) - (high - low));
  const double room = kRoom * (high - low) + 0.5 * missing;
  low_ = low - room, high_ = high + room;
  if (!axis.logarithmic && axis.ticks.empty() && low >= 0.0) low_ = 0.0;
}

bool AxisScale::shows(double value) const {
  return std::isfinite(value) && (!axis_.logarithmic || value > 0.0);
}

double AxisScale::scaled(double value) const {
  return axis_.logarithmic ? std::log10(value) : value;
}

double AxisScale::place(double value) const {
  return (scaled(value) - low_) / (high_ - low_);
}

std::vector<AxisTick> AxisScale::ticks() const {
  if (axis_.ticks.empty()) return axis_.logarithmic ? logarithmic_ticks() : linear_ticks();
  std::vector<AxisTick> ticks;
  for (const auto& [value, text] : axis_.ticks) {
    if (scaled(value) >= low_ && scaled(value) <= high_) ticks.push_back({value, text});
  }
  return ticks;
}

std::vector<AxisTick> AxisScale::logarithmic_ticks() const {
  std::vector<AxisTick> ticks;
  const bool few = high_ - low_ < kFewDecades, one = high_ - low_ < kOneDecade;
  for (int decade = int(std::floor(low_)); decade <= int(std::ceil(high_)); ++decade) {
    for (int digit = 1; digit < 10; ++digit) {
      const double value = digit * std::pow(10.0, decade);
      if (scaled(value) < low_ || scaled(value) > high_) continue;
      const bool numbered = digit == 1 || one || (few && (digit == 2 || digit == 5));
      ticks.push_back({value, numbered ? fmt::format("{:g}", value) : ""});
    }
  }
  return ticks;
}

std::vector<AxisTick> AxisScale::linear_ticks() const {
  const double raw = (high_ - low_) / 6.0, power = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = power * (raw / power < 1.5 ? 1.0 : raw / power < 3.5 ? 2.0 : 5.0);
  std::vector<AxisTick> ticks;
  for (double k = std::ceil(low_ / step); k * step <= high_; ++k)
    ticks.push_back({k * step, fmt::format("{:g}", k * step)});
  return ticks;
}

}  // namespace relume
