// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tool/chart/picture.h"

namespace relume {

struct AxisTick {
  double value = 0.0;
  std::string text;  ///< empty: a small one
};

/// Values of an axis to 0..1 of its length, with some room at both ends.
class AxisScale {
 public:
  /// `values` are those that must lie on it; those that the axis cannot show are passed over.
  AxisScale(const ChartAxis& axis, const std::vector<double>& values);

  bool shows(double value) const;
  double place(double value) const;
  std::vector<AxisTick> ticks() const;

 private:
  double scaled(double value) const;
  std::vector<AxisTick> logarithmic_ticks() const;
  std::vector<AxisTick> linear_ticks() const;

  const ChartAxis& axis_;
  double low_ = 0.0, high_ = 1.0;  ///< scaled
};

/// 0.002, 5, 20000, 1e-5: as short as it is exact to three digits.
std::string short_number(double value);

}  // namespace relume
