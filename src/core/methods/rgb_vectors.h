// SPDX-License-Identifier: MIT
//
// Vectors of one Rgb per cluster. Channels are systems of their own: a "number" of a method is one per
// channel.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
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

/// The largest size of each channel.
inline Rgb largest_size(const std::vector<Rgb>& values) {
  Rgb result(0.0);
  for (const Rgb& value : values) result = glm::max(result, glm::abs(value));
  return result;
}

/// x times factor
inline std::vector<Rgb> scaled(const Rgb& factor, const std::vector<Rgb>& x) {
  std::vector<Rgb> result = x;
  for (Rgb& value : result) value *= factor;
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

/// x over factor, zero where that is not finite: what is squared afterwards neither overflows nor vanishes.
inline std::vector<Rgb> divided(const std::vector<Rgb>& x, const Rgb& factor) {
  std::vector<Rgb> result = x;
  for (Rgb& value : result) value = quotient_or_zero(value, factor);
  return result;
}

}  // namespace relume
