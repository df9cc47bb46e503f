// SPDX-License-Identifier: MIT
//
// The words of a solve that reference and GPU share: what goes in (Lighting), when to stop (StopRule), what
// comes out (Solution).
//
//   B_i = M_i + rho_i ( H_i + sum_j K_ij b_j )     i over clusters; b: radiosity of clusters and sky patches
//   I_r = sum_j G_rj b_j                            r over lumels and sensors
//
// Arrays over clusters run over all systems, numbered through as cluster_offsets() says; arrays over gather
// rows likewise.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/model.h"
#include "core/quantities.h"
#include "core/result.h"

namespace relume {

/// All that changes at run time.
struct Lighting {
  std::vector<Rgb> albedo;         ///< per cluster, 0 <= rho < 1
  std::vector<Rgb> exitance;       ///< per cluster, lm/m2
  std::vector<Rgb> direct;         ///< H per cluster, lm/m2
  std::vector<Rgb> sky_radiosity;  ///< per sky patch, lm/m2 (pi x radiance)
};

/// Albedo and exitance as stored in the model, no direct light, a black sky.
Lighting stored_lighting(const Model& model);

/// Array lengths, finite values >= 0, albedo <= 0.9999. The error names array and index.
Result<void> check_lighting(const Model& model, const Lighting& lighting);

/// Stops after `max_bounces` applications of K, or earlier when the error bound relative to max|B| is at most
/// `tolerance`. The bounces start from B0 = M + rho H.
struct StopRule {
  std::uint32_t max_bounces = 10000;
  double tolerance = 1e-5;  ///< 0: never stop early
};

struct Solution {
  std::vector<Rgb> radiosity;  ///< B per cluster
  std::uint32_t bounces = 0;   ///< applications of K, whatever the method
  double relative_residual =
      0.0;  ///< max |r| / max |B|, r: the change that the last bounce made (the next, after 0 bounces)
  double error_bound = 0.0;  ///< bound on max |B - B_exact| / max |B|, rounding included, the worst channel;
                             ///< see ContractionBound
  std::string
      fallback;  ///< empty, or a sentence: why the method that was asked for gave way to plain bounces
};

/// The sharp bound on what remains after any number of bounces. With weights v > 0 and q = max_i (rho K_c P
/// v)_i / v_i < 1, per channel,
///   |B_i - exact_i| <= v_i max_j (|r_j| / v_j) q / (1 - q)
/// when r is the change made by the bounce that produced B (Varga, Matrix Iterative Analysis, 1962, weighted
/// maximum norms).
struct ContractionBound {
  std::vector<Rgb> weights;    ///< v per cluster, max 1
  Rgb quotient{0.0};           ///< q per channel: upper end of the bracket of the spectral radius
  Rgb lower_quotient{0.0};     ///< min_i over clusters that reflect: lower end
  std::uint32_t products = 1;  ///< that the upper end took
};

}  // namespace relume
