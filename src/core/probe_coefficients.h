// SPDX-License-Identifier: MIT
//
// Incident radiance at probes as spherical harmonics:
//
//   coefficient_lm = sum_j b_j / pi  Omega_j  Y_lm(omega_j)
//
// over the list of a probe (model.h), b_j: radiosity of the sender. Real orthonormal harmonics without the
// sign of Condon and Shortley, y up as in glTF; directions point from the probe to where light comes from.
// The first four coefficients are L1, all nine L2.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/model.h"
#include "core/solve.h"

namespace relume {

inline constexpr std::size_t kProbeHarmonics = 9;

/// Y00; y, z, x; xy, yz, 3z2 - 1, xz, x2 - y2.
using Harmonics = std::array<double, kProbeHarmonics>;

/// Means of the harmonics over directions whose mean is `direction`, of length r <= 1. They are exact for
/// r = 1 and, in the first four, for any set of directions. The others are r^3 times those of the unit
/// direction: for a cap that is a r (2 r - 1), the same but for 3 (1 - r)^2 at most.
Harmonics mean_harmonics(const glm::dvec3& direction);

/// cd/m2 times sr^1/2 each, in the order of Harmonics.
using ProbeCoefficients = std::array<Rgb, kProbeHarmonics>;

/// Of all probes by their names (Probe::name), 0 of those that are not loaded: the light that senders reflect
/// and emit, and the sky; without what arrives from punctual lights directly. `radiosity` per cluster; the
/// model is valid, the lighting fits it.
std::vector<ProbeCoefficients> probe_coefficients(const Model& model, const Lighting& lighting,
                                                  const std::vector<Rgb>& radiosity);

/// lux that arrive on a plane of unit normal, as far as nine coefficients tell (R. Ramamoorthi, P. Hanrahan,
/// An Efficient Representation for Irradiance Environment Maps, 2001): where light comes from one side that
/// may be a few per cent off, and below 0, which becomes 0. `probes`: of all; 0 where no probe has weight.
Rgb probe_irradiance(std::span<const ProbeCoefficients> probes, const WeightedProbes& at,
                     const glm::dvec3& normal);

/// Coefficients one after the other, for comparisons, and for each the Y00 of its probe: errors count
/// relative to that, for the others may be anything down to 0.
struct FlatCoefficients {
  std::vector<Rgb> values, magnitudes;
};
FlatCoefficients flat_coefficients(const std::vector<ProbeCoefficients>& probes);

}  // namespace relume
