// SPDX-License-Identifier: MIT
//
// The standard error that the rays of a model leave in the solution for given lights.
//
// A row of N independent rays finds sender j with probability F_ij, so that the irradiance that it sees has
// the variance (sum_j F_ij b_j^2 - (sum_j F_ij b_j)^2) / N. What the two halves of the row's own rays
// differed by, measured at precompute in that unit (VarianceShares), makes of it the variance of its rays. A
// cluster's row is the mean of those of its elements. Rows err independently, each once, and the error of one
// cluster reaches all others: a few solutions with errors of random sign (M. Hutchinson, A Stochastic
// Estimator of the Trace, 1990) sum up what is reflected.
//
// What cluster sizes, cuts, codes and lights get wrong is not in it; nor is light that no ray of a half
// found.
#pragma once

#include <optional>
#include <vector>

#include "core/reference_solver.h"

namespace relume {

struct RayNoise {
  std::vector<Rgb> radiosity;  ///< per cluster, lm/m2: standard error
  /// Per gather row, lux, through form factors. Of sensors, whose rays the model does not tell, only what
  /// errors of the clusters bring them.
  std::vector<Rgb> irradiance;
  bool measured = false;  ///< by the halves of rows; else rays count as independent, and these are better
};

/// `radiosity` solves `matrices`, which are those of `model`, for `lighting`. The same model and lights give
/// the same numbers. Nothing where some system does not tell its rays.
std::optional<RayNoise> ray_noise(const Model& model, const ReferenceMatrices& matrices,
                                  const Lighting& lighting, const std::vector<Rgb>& radiosity);

}  // namespace relume
