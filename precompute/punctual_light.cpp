// SPDX-License-Identifier: MIT
#include "precompute/punctual_light.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace relume {

double solid_angle(const glm::dvec3& from, const TriangleCorners& corners) {
  const glm::dvec3 a = corners[0] - from;
  const glm::dvec3 b = corners[1] - from;
  const glm::dvec3 c = corners[2] - from;
  const double la = glm::length(a);
  const double lb = glm::length(b);
  const double lc = glm::length(c);
  const double volume = std::abs(glm::dot(a, glm::cross(b, c)));
  const double denominator = la * lb * lc + glm::dot(a, b) * lc + glm::dot(a, c) * lb + glm::dot(b, c) * la;
  return volume > 0.0 ? 2.0 * std::atan2(volume, denominator) : 0.0;
}

double intensity_share(const Light& light, const glm::dvec3& point) {
  const glm::dvec3 way = point - light.position;
  const double distance = glm::length(way);
  if (distance == 0.0) return 0.0;
  double share = 1.0;
  if (light.range > 0.0) share = std::clamp(1.0 - std::pow(distance / light.range, 4.0), 0.0, 1.0);
  if (light.type != LightType::spot) return share;
  const double inner = std::cos(light.inner_cone_angle);
  const double outer = std::cos(light.outer_cone_angle);
  const double cosine = glm::dot(way, light.direction) / distance;
  const double falloff = std::clamp((cosine - outer) / std::max(0.001, inner - outer), 0.0, 1.0);
  return share * falloff * falloff;
}

bool may_reach(const Light& light, const TriangleCorners& corners) {
  if (light.type == LightType::directional) return true;
  const glm::dvec3 centre = (corners[0] + corners[1] + corners[2]) / 3.0;
  double radius = 0.0;
  for (const glm::dvec3& corner : corners) radius = std::max(radius, glm::length(corner - centre));
  const double distance = glm::length(centre - light.position);
  if (light.range > 0.0 && distance - radius >= light.range) return false;
  if (light.type == LightType::point || distance <= radius) return true;
  // The triangle lies in a ball; the ball in a cone of this half angle about its centre.
  const double half_angle = std::asin(radius / distance);
  const double cosine = glm::dot(centre - light.position, light.direction) / distance;
  return std::acos(std::clamp(cosine, -1.0, 1.0)) - half_angle <= light.outer_cone_angle;
}

Rgb irradiance_at_point(const Light& light, const glm::dvec3& point, const glm::dvec3& normal) {
  if (light.type == LightType::directional) {
    return light.intensity * std::max(0.0, -glm::dot(normal, light.direction));
  }
  const glm::dvec3 way = light.position - point;
  const double squared = glm::dot(way, way);
  if (squared == 0.0) return Rgb(0.0);
  const double cosine = std::max(0.0, glm::dot(normal, way) / std::sqrt(squared));
  return light.intensity * (intensity_share(light, point) * cosine / squared);
}

}  // namespace relume
