// SPDX-License-Identifier: MIT
#include "core/methods/certified_solve.h"
#include "core/methods/methods.h"

namespace relume {

Result<Solution> solve_by_bounces(const BounceProblem& problem, const StopRule& rule,
                                  const BounceObserver& observer) {
  CertifiedSolve solve(problem, rule, observer);
  std::vector<Rgb> x = problem.source;
  while (!solve.done()) x = solve.bounce(x);
  return std::move(solve).finish();
}

}  // namespace relume
