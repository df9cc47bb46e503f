// SPDX-License-Identifier: MIT
//
// The quantities of Relume, their units, and every factor of pi. No other file multiplies or divides by pi to
// turn one quantity into another.
//
//   radiosity   B  lm/m2   leaves a diffuse surface, emitted + reflected
//   exitance    M  lm/m2   the emitted part of B
//   irradiance  H  lm/m2   arrives directly from punctual lights (point, spot, directional)
//   irradiance  I  lm/m2   arrives from surfaces and the sky, through form factors
//   radiance    L  cd/m2   L = B / pi for a diffuse surface
//   albedo      rho        reflected / arriving flux, 0..1 per channel
//   intensity      cd      of point and spot lights: irradiance = intensity cos(theta) / d2
//   form factor F_ij       fraction of receiver i's cosine-weighted hemisphere that sender j covers;
//                          A_i F_ij = A_j F_ji
//
// Lengths are metres, axes are those of glTF (right-handed, +Y up), colours are linear Rec.709.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>

namespace relume {

/// A quantity per colour channel, in double precision.
using Rgb = glm::dvec3;

inline constexpr double kPi = std::numbers::pi;

/// Exitance (lm/m2) of a diffuse emitter of radiance L (cd/m2). Also the radiosity that a sky patch sends.
inline Rgb exitance_from_radiance(const Rgb& radiance) {
  return kPi * radiance;
}

/// Radiance (cd/m2) of a diffuse surface of radiosity B (lm/m2).
inline Rgb radiance_from_radiosity(const Rgb& radiosity) {
  return radiosity / kPi;
}

/// Luminance of linear Rec.709, or the like of any other quantity: what the eye makes of its channels.
inline double luminance(const Rgb& linear) {
  return 0.2126 * linear.r + 0.7152 * linear.g + 0.0722 * linear.b;
}

}  // namespace relume
