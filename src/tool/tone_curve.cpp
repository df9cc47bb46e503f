// SPDX-License-Identifier: MIT
#include "tool/tone_curve.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relume {
namespace {

constexpr double kMiddleGrey = 0.3;
constexpr double kWhiteQuantile = 0.985;

double quantile(std::vector<double> values, double share) {
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

ToneCurve fit_tone_curve(std::span<const Rgb> radiance) {
  std::vector<double> lit;
  double sum = 0.0;
  for (const Rgb& sample : radiance) sum += luminance(sample);
  const double black = 1e-6 * sum / static_cast<double>(std::max<std::size_t>(radiance.size(), 1));
  double log_sum = 0.0;
  for (const Rgb& sample : radiance) {
    const double value = luminance(sample);
    if (value <= black) continue;
    lit.push_back(value);
    log_sum += std::log(value);
  }
  if (lit.empty()) return {};
  ToneCurve curve;
  curve.exposure = kMiddleGrey / std::exp(log_sum / static_cast<double>(lit.size()));
  curve.white = std::max(1.0, curve.exposure * quantile(std::move(lit), kWhiteQuantile));
  return curve;
}

Rgb tone_mapped(const ToneCurve& curve, const Rgb& radiance) {
  const Rgb exposed = curve.exposure * radiance;
  const double bright = luminance(exposed);
  const double scale = (1.0 + bright / (curve.white * curve.white)) / (1.0 + bright);
  return glm::clamp(scale * exposed, Rgb(0.0), Rgb(1.0));
}

}  // namespace relume
