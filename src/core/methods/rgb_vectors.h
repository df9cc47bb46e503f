// SPDX-License-Identifier: MIT
//
// Vectors of one Rgb per cluster. Channels are systems of their own: a "number" of a method is one per
// channel.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "core/quantities.h"

namespace relume {

inline Rgb dot(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  Rgb sum(0.0);
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// y += factor x
inline void add_scaled(const Rgb& factor, const std::vector<Rgb>& x, std::vector<Rgb>& y) {
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += factor * x[i];
}

inline std::vector<Rgb> difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  std::vector<Rgb> result = a;
  for (std::size_t i = 0; i < a.size(); ++i) result[i] -= b[i];
  return result;
}

/// What is below zero becomes zero.
inline void clamp_at_zero(std::vector<Rgb>& x) {
  for (Rgb& value : x) {
    for (int channel = 0; channel < 3; ++channel) {
      if (!(value[channel] > 0.0)) value[channel] = 0.0;
    }
  }
}

/// Zero where the quotient is not a finite number: a channel that has converged, or broken down, stands
/// still.
inline Rgb quotient_or_zero(const Rgb& numerator, const Rgb& denominator) {
  Rgb result(0.0);
  for (int channel = 0; channel < 3; ++channel) {
    const double quotient = numerator[channel] / denominator[channel];
    if (std::isfinite(quotient)) result[channel] = quotient;
  }
  return result;
}

}  // namespace relume
