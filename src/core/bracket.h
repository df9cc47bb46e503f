// SPDX-License-Identifier: MIT
//
// Between which values the solution of the full rows lies, told from the cut ones: interval iteration, where
// a node stands for the least and the most of its leaves instead of their mean, and a stored form factor for
// all that its code may mean.
//
//   high_i = M_i + rho_i ( H_i + sum_n K_in max_{j in n} high_j + slack_i ),  low_i likewise from the minima
//
// The form factor to a node is the sum of those to its leaves, so whatever the rays shared out among the
// leaves, the solution of the rows before they were cut and encoded lies inside (hierarchical bounds:
// Lischinski, Smits, Greenberg, Bounds and Error Estimates for Radiosity, 1994). What rays, cluster sizes and
// lights get wrong is not in it.
#pragma once

#include <functional>
#include <vector>

#include "core/reference_solver.h"

namespace relume {

struct Bracket {
  std::vector<Rgb> low;
  std::vector<Rgb> high;
};

struct SolutionBracket {
  Bracket radiosity;   ///< per cluster, lm/m2
  Bracket irradiance;  ///< per gather row, lux: through form factors, as gather()
  std::uint32_t products = 0;
};

/// All systems must be loaded: only then do the errors of a row's values make up for each other.
/// `slack`: reference_slack of the model that `matrices` are from. `start`: near the solution, best that of a
/// solver. Iterated until what is left is 1e-6 of the largest radiosity, and widened by it. Refused
/// (check_failed) where the intervals need not stay finite: max_i rho_i (sum_j K_ij + 2 slack_ij) of 1 or
/// more; `cancelled` when `go_on` (asked before each product) returns false.
Result<SolutionBracket> bracket_solution(const ReferenceMatrices& matrices, const ReferenceMatrices& slack,
                                         const Lighting& lighting, const std::vector<Rgb>& start,
                                         const std::function<bool()>& go_on = {});

/// (high - low) / value of the sum of the channels, per row; 0 where the value is 0.
std::vector<double> relative_widths(const Bracket& bracket, const std::vector<Rgb>& values);

}  // namespace relume
