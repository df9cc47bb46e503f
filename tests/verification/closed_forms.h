// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "core/quantities.h"

namespace relume::test {

/// Form factor from a surface element to a polygon that lies wholly above its horizon (J. H. Lambert,
/// Photometria, 1760; J. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, contour
/// integral). Corners clockwise seen from the element give a positive number.
inline double element_to_polygon(const glm::dvec3& point, const glm::dvec3& normal,
                                 std::span<const glm::dvec3> corners) {
  double sum = 0.0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const glm::dvec3 a = glm::normalize(corners[k] - point);
    const glm::dvec3 b = glm::normalize(corners[(k + 1) % corners.size()] - point);
    const glm::dvec3 across = glm::cross(b, a);
    const double sine = glm::length(across);
    if (sine > 0.0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(across / sine, normal);
  }
  return sum / (2.0 * kPi);
}

/// From an element to a parallel rectangle of a x b at distance c whose corner stands straight above it
/// (Howell, B-3).
inline double element_to_parallel_rectangle(double a, double b, double c) {
  const double x = a / c, y = b / c, p = std::sqrt(1.0 + x * x), q = std::sqrt(1.0 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2.0 * kPi);
}

}  // namespace relume::test
