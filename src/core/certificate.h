// SPDX-License-Identifier: MIT
//
// The certificate of a solution, whichever method found it: the change that one plain bounce makes, through
// the bound of ContractionBound.
#pragma once

#include <vector>

#include "core/reference_solver.h"

namespace relume {

/// What one bounce changed, per channel; infinite where a value is not finite.
struct Change {
  Rgb largest{0.0};   ///< max |r_j|
  Rgb weighted{0.0};  ///< max |r_j| / v_j
  /// The same of what the bounce may have rounded: a row of n terms, nodes of at most m leaves, by less than
  /// (n + m + 4) ulp of the sum of their sizes.
  Rgb rounding{0.0};
};

/// `after` is the plain bounce of `before`. Entries of `before` may be negative.
Change measure_change(const SenderMatrix& matrix, const ContractionBound& contraction,
                      const std::vector<Rgb>& before, const std::vector<Rgb>& after);

/// The same of a bounce whose result is off by at most `rounding` of it.
Change measure_change(const ContractionBound& contraction, double rounding, const std::vector<Rgb>& before,
                      const std::vector<Rgb>& after);

/// Sets residual and error bound of solution.radiosity. All further bounces add up to a geometric series
/// whose first term is at most `first` times the change (q for what came after that bounce, 1 for what was
/// before it), and each rounds.
void rate_solution(const Change& change, const Rgb& first, const Rgb& quotient, Solution& solution);

}  // namespace relume
