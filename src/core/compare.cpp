// SPDX-License-Identifier: MIT
#include "core/compare.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <utility>

namespace relume {
namespace {

double absolute_error(double value, double reference) {
  if (!std::isfinite(value) || !std::isfinite(reference)) return std::numeric_limits<double>::infinity();
  return std::abs(value - reference);
}

double relative_error(double absolute, double magnitude, double floor) {
  return absolute == 0.0 ? 0.0 : absolute / std::max(std::abs(magnitude), floor);
}

double largest_channel(std::span<const Rgb> values) {
  double result = 0.0;
  for (const Rgb& value : values) {
    for (int channel = 0; channel < 3; ++channel) result = std::max(result, std::abs(value[channel]));
  }
  return result;
}

std::size_t histogram_bin(double error, std::size_t bins) {
  double lower_edge = 0.1;
  for (std::size_t bin = 0; bin + 1 < bins; ++bin, lower_edge /= 10.0) {
    if (error >= lower_edge) return bin;
  }
  return bins - 1;
}

}  // namespace

Comparison compare(std::string name, std::span<const Rgb> values, std::span<const Rgb> reference,
                   std::span<const Rgb> magnitudes) {
  assert(values.size() == reference.size());
  if (magnitudes.empty()) magnitudes = reference;
  assert(values.size() == magnitudes.size());
  Comparison result;
  result.name = std::move(name);
  result.count = values.size();
  const double floor = 1e-4 * largest_channel(magnitudes);
  double sum_of_squares = 0.0;
  for (std::size_t index = 0; index < values.size(); ++index) {
    for (int channel = 0; channel < 3; ++channel) {
      const double value = values[index][channel];
      const double expected = reference[index][channel];
      const double absolute = absolute_error(value, expected);
      const double error = relative_error(absolute, magnitudes[index][channel], floor);
      sum_of_squares += error * error;
      ++result.histogram[histogram_bin(error, result.histogram.size())];
      result.max_absolute_error = std::max(result.max_absolute_error, absolute);
      const bool first = index == 0 && channel == 0;
      if (first || error > result.max_relative_error) {
        result.max_relative_error = error;
        result.worst_index = index;
        result.worst_channel = channel;
        result.worst_value = value;
        result.worst_reference = expected;
      }
    }
  }
  if (result.count > 0) {
    result.rms_relative_error = std::sqrt(sum_of_squares / (3.0 * static_cast<double>(result.count)));
  }
  return result;
}

}  // namespace relume
