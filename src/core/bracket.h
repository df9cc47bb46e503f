// SPDX-License-Identifier: MIT
//
// Between which values the solution of the full rows lies, told from the cut ones: interval iteration, where
// a node stands for the least and the most that its leaves may make of it (as halvings allow, or else its
// darkest and brightest leaf) instead of their mean, and a stored form factor for all that its code may mean.
//
//   high_i = M_i + rho_i ( H_i + most of sum_j F_ij high_j ),  low_i likewise with the least
//
// over all rows of leaves that a row may come from (loose_rows.h), so whatever the rays shared out among the
// leaves, the solution of the rows before they were cut and encoded lies inside (hierarchical bounds:
// Lischinski, Smits, Greenberg, Bounds and Error Estimates for Radiosity, 1994). That needs no more than
// intervals that the iteration maps into themselves: a bounce of the full rows maps everything inside of them
// into them as well, and full rows of a sum and an albedo below 1 have but one solution, which bounces from
// anywhere reach. What rays, cluster sizes and lights get wrong is not in it.
#pragma once

#include <functional>
#include <vector>

#include "core/loose_rows.h"

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

/// `matrices`: of a model all of whose systems are loaded; only then do the errors of a row's values make up
/// for each other. `start`: near the solution, best that of a solver. Iterated outwards until the intervals
/// hold what an iteration makes of them, then inwards until that hardly narrows them. Refused (check_failed)
/// where max_i rho_i sum_j F_ij is 1 or more, and where intervals grow without end; `cancelled` when `go_on`
/// (asked before each product) returns false.
Result<SolutionBracket> bracket_solution(const LooseMatrices& matrices, const Lighting& lighting,
                                         const std::vector<Rgb>& start,
                                         const std::function<bool()>& go_on = {});

/// (high - low) / value of the sum of the channels, per row; 0 where the value is 0.
std::vector<double> relative_widths(const Bracket& bracket, const std::vector<Rgb>& values);

}  // namespace relume
