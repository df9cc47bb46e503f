// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "core/quantities.h"

namespace relume {

enum class LightType : std::uint32_t { point = 0, spot = 1, directional = 2 };

/// A punctual light as in KHR_lights_punctual, in world space.
///
/// Irradiance that it gives to a surface with unit normal n, when nothing is in between:
///   point        intensity * max(0, cos) / d^2
///   spot         the same times a^2,
///                a = clamp((cos(angle) - cos(outer)) / max(0.001, cos(inner) - cos(outer)), 0, 1)
///   directional  intensity * max(0, cos)
/// A range (0 = none) multiplies point and spot lights by clamp(1 - (d / range)^4, 0, 1).
struct Light {
  LightType type = LightType::point;
  std::string name;
  Rgb intensity{0.0};                    ///< colour x intensity: cd (point, spot), lux (directional)
  glm::dvec3 position{0.0};              ///< m; unused by directional lights
  glm::dvec3 direction{0.0, 0.0, -1.0};  ///< unit, where it shines; unused by point lights
  double range = 0.0;                    ///< m, 0 = no limit
  double inner_cone_angle = 0.0;         ///< radians, spot only
  double outer_cone_angle = kPi / 4.0;   ///< radians, spot only
};

}  // namespace relume
