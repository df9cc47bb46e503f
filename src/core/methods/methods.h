// SPDX-License-Identifier: MIT
//
// Ways to solve B = S + rho K B with fewer products than plain bounces (core/reference_solver.h). Each is a
// free function that takes a BounceProblem and a StopRule: `max_bounces` limits the applications of K, and
// one sweep or as many shots as there are clusters count as one, since they cost as much. Each returns a
// Solution whose bound is certified by a plain bounce (core/methods/certified_solve.h): light is never
// negative, and a method that stalls or diverges gives way to plain bounces and says so in
// Solution::fallback.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/methods/bounce_problem.h"
#include "core/methods/near_and_far.h"
#include "core/methods/room_correction.h"
#include "core/rooms.h"

namespace relume {

/// Plain bounces.
Result<Solution> solve_by_bounces(const BounceProblem& problem, const StopRule& rule,
                                  const BounceObserver& observer = {});

/// Plain bounces that start with one irradiance everywhere on top of S: the one that keeps the balance of all
/// light if every surface receives alike. (The ambient term of M. Cohen et al., A Progressive Refinement
/// Approach to Fast Radiosity Image Generation, 1988.) One product more finds the row sums.
Result<Solution> solve_with_ambient_start(const BounceProblem& problem, const StopRule& rule,
                                          const BounceObserver& observer = {});

/// Where the spectrum of rho K lies: real, which it is when K is symmetric in A.
struct SpectralInterval {
  Rgb lower{0.0};
  Rgb upper{0.0};
};

/// [-q, q] of the contraction: it holds the spectrum of any rho K, but those of clustered or cut rows need
/// not be real.
SpectralInterval safe_interval(const BounceProblem& problem);

/// Chebyshev semi-iteration (R. Varga, Matrix Iterative Analysis, 1962, section 5.1). Bounces go on where it
/// diverges.
Result<Solution> solve_by_chebyshev(const BounceProblem& problem, const SpectralInterval& interval,
                                    const StopRule& rule, const BounceObserver& observer = {});

/// |A_i K_ij - A_j K_ji| summed over all pairs of clusters, over the sum of all A_i K_ij: 0 where A K is
/// symmetric, up to 2. K may have no nodes.
double symmetry_defect(const CsrMatrix& rows, const std::vector<double>& areas);

/// Above this defect conjugate gradients are refused: they no longer solve the problem to more digits than
/// this.
inline constexpr double kMaxSymmetryDefect = 1e-3;

/// Conjugate gradients on the symmetric form (1 - N) y = sqrt(rho A) K S, N = sqrt(rho / A) A K sqrt(rho /
/// A), B = S + sqrt(rho / A) y (M. Hestenes, E. Stiefel, 1952): black clusters are zero rows of N. Refused
/// (check_failed) where the matrix has nodes, or a symmetry defect above `max_defect`.
Result<Solution> solve_by_conjugate_gradients(const BounceProblem& problem, const StopRule& rule,
                                              const BounceObserver& observer = {},
                                              double max_defect = kMaxSymmetryDefect);

/// BiCGSTAB (H. van der Vorst, 1992): two products a step, no symmetry needed.
Result<Solution> solve_by_bicgstab(const BounceProblem& problem, const StopRule& rule,
                                   const BounceObserver& observer = {});

/// 2 / (1 + sqrt(1 - lambda^2)), lambda the lower end of the bracket: D. Young, Iterative Methods for Solving
/// Partial Difference Equations of Elliptic Type, 1954. Best where clusters can be coloured, and near the
/// best elsewhere.
Rgb over_relaxation(const BounceProblem& problem);

/// Gauss-Seidel sweeps, each value over-relaxed by `omega`, per channel in (0, 2); 1 is Gauss-Seidel. Bounces
/// go on where it diverges.
Result<Solution> solve_by_over_relaxation(const BounceProblem& problem, const Rgb& omega,
                                          const StopRule& rule, const BounceObserver& observer = {});

/// Southwell's relaxation, which is progressive refinement (S. Gortler, M. Cohen, P. Slusallek, Radiosity and
/// Relaxation Methods, 1994): the cluster with the most light not yet sent sends it.
Result<Solution> solve_by_shooting(const BounceProblem& problem, const StopRule& rule,
                                   const BounceObserver& observer = {});

/// Two levels: between bounces, one irradiance per room is found from the balance of light between rooms
/// (core/methods/room_correction.h), and cluster i gets rho_i times that of its room. What falls below zero
/// is clamped, and a correction after which the weighted residual does not come down again is taken back.
Result<Solution> solve_by_two_levels(const BounceProblem& problem, const Rooms& rooms, const StopRule& rule,
                                     const BounceObserver& observer = {});

/// GMRES (Y. Saad, M. Schultz, 1986) on the problem as two levels leave it (core/methods/near_and_far.h):
/// light that goes to and fro in gaps below, light between groups above. One product a step. Fails with
/// usage where the levels are of another number of clusters.
Result<Solution> solve_by_gmres(const BounceProblem& problem, const NearAndFar& levels, const StopRule& rule,
                                const BounceObserver& observer = {});

/// Every way to solve, by name. `ambient`: with an ambient start; `shooting`: Southwell.
enum class Method {
  bounces,
  ambient,
  chebyshev,
  conjugate_gradients,
  bicgstab,
  gauss_seidel,
  over_relaxation,
  shooting,
  two_level,
  two_level_gmres
};

/// "bounces", "ambient", "chebyshev", "cg", "bicgstab", "gauss-seidel", "sor", "shooting", "two-level",
/// "two-level-gmres"; in the order of Method.
const std::vector<std::string>& method_names();

/// What the methods of two levels know of a scene, whatever its albedo.
struct SceneLevels {
  Rooms rooms;              ///< of two_level
  NearAndFar near_and_far;  ///< of two_level_gmres
};

/// What `method` needs; nothing for the others.
SceneLevels scene_levels(Method method, const Model& model, const SenderMatrix& bounce_matrix);

/// By the method's own defaults. Of `levels`, what the method does not use may be empty.
Result<Solution> solve_by(Method method, const BounceProblem& problem, const SceneLevels& levels,
                          const StopRule& rule, const BounceObserver& observer = {});

/// What the choice of a method looks at.
struct ScenePrediction {
  Rgb spectral_radius{0.0};               ///< upper end of its bracket, per channel
  double closure = 0.0;                   ///< mean row sum by area, of what feeds back
  double bounces = 0.0;                   ///< plain bounces to the tolerance: ln tolerance / ln q
  std::optional<double> symmetry_defect;  ///< absent with nodes
};

/// The fastest method that is safe for one solve of the scene, what it costs to find the levels included, and
/// why, in words. Whoever keeps the levels for many solves does best with them throughout.
struct MethodChoice {
  Method method = Method::bounces;
  std::string reason;
  std::optional<ScenePrediction> scene;  ///< absent where it was not looked at
};

MethodChoice choose_method(const BounceProblem& problem, const StopRule& rule);

}  // namespace relume
