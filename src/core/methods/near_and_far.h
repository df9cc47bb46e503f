// SPDX-License-Identifier: MIT
//
// Two levels for Krylov methods: what nearly solves (1 - rho K) z = v without a product by K.
//
// K = N + F. N is the few largest form factors: those inside gaps and corners, where light goes to and fro
// longest. y = v + rho N y is solved by sweeps of Gauss-Seidel, which cost little. What y lacks, e, is due to
// what is far: e = rho c, c = K e + F y. That is smooth: c is taken as one irradiance in each group of
// clusters that light falls on alike, and its balance holds in their means by area,
//   c_g - sum_h K_gh rho_h c_h = sum_h F_gh y_h,   K_gh = 1 / A_g sum over i in g, j in h of A_i K_ij,
// rho_h and y_h means by area, too. z = y + rho c. N, K_gh and F_gh know no albedo.
#pragma once

#include <cstdint>
#include <vector>

#include "core/methods/rgb_lu.h"
#include "core/rooms.h"

namespace relume {

struct NearAndFar {
  CsrMatrix near;             ///< N, clusters x clusters
  Rooms groups;               ///< see alike_groups
  std::vector<double> areas;  ///< m2, per cluster
  std::vector<double> all;    ///< K_gh, groups x groups, row by row
  std::vector<double> far;    ///< F_gh, as well
};

/// Costs about as much as 50 products of RGB vectors. `areas` per cluster, m2, above 0.
NearAndFar near_and_far(const SenderMatrix& bounce_matrix, const std::vector<double>& areas);

/// Of one albedo.
class NearAndFarSolver {
 public:
  /// Both must live as long as the solver.
  NearAndFarSolver(const NearAndFar& split, const std::vector<Rgb>& albedo);

  /// z: linear in v.
  std::vector<Rgb> solve(const std::vector<Rgb>& v) const;

 private:
  const NearAndFar& split_;
  const std::vector<Rgb>& albedo_;
  RgbLu balance_;
};

}  // namespace relume
