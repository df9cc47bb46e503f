// SPDX-License-Identifier: MIT
#include <glm/common.hpp>

#include "core/methods/certified_solve.h"
#include "core/methods/methods.h"
#include "core/methods/rgb_vectors.h"

namespace relume {
namespace {

/// What cluster j sends arrives on surfaces to the share k_j (its row sum, by reciprocity). With B = S + rho
/// c the irradiance c of all surfaces is sum A k S + c sum A k rho, over their area.
Rgb ambient_irradiance(const BounceProblem& problem, const std::vector<Rgb>& row_sums) {
  Rgb sent(0.0), kept(0.0);
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const Rgb arriving = problem.areas[i] * glm::min(row_sums[i], Rgb(1.0));
    sent += arriving * problem.source[i];
    kept += problem.areas[i] - arriving * problem.albedo[i];
  }
  return quotient_or_zero(sent, kept);
}

}  // namespace

Result<Solution> solve_with_ambient_start(const BounceProblem& problem, const StopRule& rule,
                                          const BounceObserver& observer) {
  CertifiedSolve solve(problem, rule, observer);
  const Rgb ambient =
      ambient_irradiance(problem, solve.irradiance(std::vector<Rgb>(problem.size(), Rgb(1.0))));
  std::vector<Rgb> x = problem.source;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += problem.albedo[i] * ambient;
  while (!solve.done()) x = solve.bounce(x);
  return std::move(solve).finish();
}

}  // namespace relume
