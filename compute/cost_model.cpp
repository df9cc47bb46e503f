// SPDX-License-Identifier: MIT
#include "compute/cost_model.h"

#include <algorithm>
#include <limits>

namespace relume {
namespace {

/// Sums of weighted least squares of y = a + b x, weights 1 / y^2.
struct Sums {
  double one = 0.0, x = 0.0, xx = 0.0, y = 0.0, xy = 0.0;
};

Sums sums_of(std::span<const FrameTime> samples) {
  Sums sums;
  for (const FrameTime& sample : samples) {
    if (!(sample.seconds > 0.0)) continue;
    const double weight = 1.0 / (sample.seconds * sample.seconds);
    const double x = static_cast<double>(sample.form_factors);
    sums.one += weight;
    sums.x += weight * x;
    sums.xx += weight * x * x;
    sums.y += weight * sample.seconds;
    sums.xy += weight * x * sample.seconds;
  }
  return sums;
}

}  // namespace

CostModel fit_cost_model(std::span<const FrameTime> samples) {
  const Sums sums = sums_of(samples);
  if (sums.one <= 0.0) return {};
  const double determinant = sums.one * sums.xx - sums.x * sums.x;
  if (determinant > 1e-9 * sums.one * sums.xx) {
    const double a = (sums.y * sums.xx - sums.x * sums.xy) / determinant;
    const double b = (sums.one * sums.xy - sums.x * sums.y) / determinant;
    if (a >= 0.0 && b >= 0.0) return {a, b};
    if (b < 0.0) return {sums.y / sums.one, 0.0};
  }
  if (sums.xx <= 0.0) return {sums.y / sums.one, 0.0};
  return {0.0, sums.xy / sums.xx};
}

std::uint64_t form_factors_within(const CostModel& model, double seconds) {
  if (seconds <= model.per_frame) return 0;
  constexpr double kMost = 1e18;
  if (model.per_form_factor * kMost <= seconds - model.per_frame) {
    return std::numeric_limits<std::uint64_t>::max();
  }
  return static_cast<std::uint64_t>((seconds - model.per_frame) / model.per_form_factor);
}

}  // namespace relume
