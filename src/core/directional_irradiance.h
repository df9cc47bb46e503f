// SPDX-License-Identifier: MIT
//
// Directional lightmaps: of the irradiance of a receiver also its first moment, which tells where light comes
// from,
//
//   D_r = sum_j G_rj m_rj b_j          (I_r = sum_j G_rj b_j)
//
// G and b as in solve.h; m_rj: mean of the directions from receiver r to what it sees of sender j, each
// weighed as G weighs it (with the cosine at the receiver), in world space, no longer than 1
// (MatrixBlock::directions). So |D| <= I in every channel. Light of punctual lights that arrives directly is
// not in it.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "core/model.h"
#include "core/solve.h"

namespace relume {

/// D along x, y and z: lm/m2.
using IrradianceMoments = std::array<Rgb, 3>;

/// Whether the gather matrix of any of its systems has directions.
bool is_directional(const Model& model);
bool is_directional(const System& system);

/// Per gather row; none where the model is not directional. `radiosity` per cluster; the model is valid, the
/// lighting fits it.
std::vector<IrradianceMoments> directional_irradiance(const Model& model, const Lighting& lighting,
                                                      const std::vector<Rgb>& radiosity);

/// d = luminance of D / luminance of I, no longer than 1, in world space: points to where most light comes
/// from; its length tells how much of it comes from there (1: all; 2/3, along the normal: a hemisphere of
/// even radiance). 0 where it is dark.
glm::dvec3 dominant_direction(const IrradianceMoments& moments, const Rgb& irradiance);

/// By how much the irradiance changes when the normal is `bent` instead of `normal` (both unit), estimated
/// from d:
///
///   max(0, 2 (1 - |d|) + dot(d, bent)) / (2 (1 - |d|) + dot(d, normal)), at most 4
///
/// 1 for the normal itself and never negative. Light of the form a + b cos(angle to d) leads to it; how much
/// of it is a follows from |d| such that it is right in both cases that are known: a hemisphere of even
/// radiance around the normal, d = 2/3 normal, gives (1 + cos) / 2; light from one direction, |d| = 1, gives
/// max(0, dot(d, bent)) / dot(d, normal). The limit keeps light that grazes the surface from lighting every
/// bump.
double bent_irradiance_factor(const glm::dvec3& d, const glm::dvec3& normal, const glm::dvec3& bent);

/// Moments one after the other, for comparisons, and for each the irradiance of its row: errors count
/// relative to that, for moments may be anything down to 0.
struct FlatMoments {
  std::vector<Rgb> values, magnitudes;
};
FlatMoments flat_moments(const std::vector<IrradianceMoments>& moments, const std::vector<Rgb>& irradiance);

}  // namespace relume
