// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <vector>

#include "core/reference_solver.h"

namespace relume {

/// What every method solves, i over clusters, per channel:
///   B = S + rho K B,   S = M + rho (H + K_s b_sky),   K = K_c P
/// with what is known of it: q < 1, so there is one solution, and it is not negative.
struct BounceProblem {
  const SenderMatrix* matrix = nullptr;  ///< of whoever made the problem; may be null where `product` is set
  std::vector<Rgb> albedo;
  std::vector<Rgb> source;    ///< S, lm/m2
  std::vector<double> areas;  ///< m2
  ContractionBound contraction;
  /// K x by other hands than cluster_product of the matrix. Then only bounces, chebyshev and BiCGSTAB can
  /// solve it.
  std::function<std::vector<Rgb>(const std::vector<Rgb>& x)> product{};
  /// What a bounce by `product` may round, of its result: a solve ends when its change is no more than that.
  double product_rounding = 0.0;

  std::size_t size() const { return albedo.size(); }
};

/// `areas` per cluster, above 0. The matrix must live as long as the problem. Refused (check_failed) where an
/// array does not fit the matrix, and by check_contraction.
Result<BounceProblem> make_bounce_problem(const SenderMatrix& matrix, const Lighting& lighting,
                                          std::vector<double> areas);

/// Areas of the clusters of all systems, m2.
std::vector<double> cluster_areas(const Model& model);

}  // namespace relume
