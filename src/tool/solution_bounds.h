// SPDX-License-Identifier: MIT
//
// `solve --bounds`: between which values the answer of the full rows lies.
#pragma once

#include <string>

#include "core/bracket.h"
#include "tool/solver.h"

namespace relume {

struct SolutionBounds {
  SolutionBracket bracket;
  double median_width = 0.0;  ///< (high - low) / value over valid lumels with light
  double widest = 0.0;        ///< of 95 in 100 of them
};

/// Of what `outcome` solved.
Result<SolutionBounds> bound_solution(const Model& model, const Lighting& lighting,
                                      const SolveOutcome& outcome, Console& console);

/// One sentence for people.
std::string bounds_sentence(const SolutionBounds& bounds);

/// The object `bounds` of `solve --json`.
JsonValue bounds_json(const SolutionBounds& bounds);

}  // namespace relume
