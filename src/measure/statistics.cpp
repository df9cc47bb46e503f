// SPDX-License-Identifier: MIT
#include "measure/statistics.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace relume {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double relative_difference(std::span<const Rgb> a, std::span<const Rgb> b) {
  double difference = 0.0, total = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += glm::dot(a[i] - b[i], a[i] - b[i]);
    total += glm::dot(b[i], b[i]);
  }
  return difference == 0.0 ? 0.0 : std::sqrt(difference / total);
}

}  // namespace relume
