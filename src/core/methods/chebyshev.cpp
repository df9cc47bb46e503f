// SPDX-License-Identifier: MIT
#include <glm/vector_relational.hpp>
#include <utility>

#include "core/methods/certified_solve.h"
#include "core/methods/methods.h"

namespace relume {
namespace {

/// Times that the residual may be this much above the best so far before the interval is taken to be wrong.
constexpr int kGrowingTimes = 2;
constexpr double kGrowth = 10.0;

/// The residual may rise at first, by the shape of the polynomials; not by far, and not for long.
class GrowthWatch {
 public:
  bool grows(const CertifiedSolve& solve) {
    const Rgb limit = kGrowth * solve.best_weighted_change();
    const bool small = glm::all(glm::lessThanEqual(solve.weighted_change(), limit));
    times_ = small ? 0 : times_ + 1;
    return times_ >= kGrowingTimes;
  }

 private:
  int times_ = 0;
};

}  // namespace

SpectralInterval safe_interval(const BounceProblem& problem) {
  return {-problem.contraction.quotient, problem.contraction.quotient};
}

Result<Solution> solve_by_chebyshev(const BounceProblem& problem, const SpectralInterval& interval,
                                    const StopRule& rule, const BounceObserver& observer) {
  CertifiedSolve solve(problem, rule, observer);
  const Rgb width = 2.0 - (interval.upper + interval.lower);
  const Rgb gamma = 2.0 / width;
  const Rgb sigma = (interval.upper - interval.lower) / width;
  GrowthWatch watch;
  Rgb omega(1.0);
  std::vector<Rgb> before(problem.size(), Rgb(0.0));
  std::vector<Rgb> x = problem.source;
  for (bool first = true; !solve.done(); first = false) {
    const std::vector<Rgb> bounced = solve.bounce(x);
    if (watch.grows(solve))
      return std::move(solve).fall_back("Chebyshev diverged: its spectral interval was wrong");
    if (!first) omega = 1.0 / (1.0 - sigma * sigma * omega * 0.25);
    std::vector<Rgb> next(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Rgb relaxed = x[i] + gamma * (bounced[i] - x[i]);
      next[i] = first ? relaxed : before[i] + omega * (relaxed - before[i]);
    }
    if (first) omega = Rgb(2.0);
    before = std::exchange(x, std::move(next));
  }
  return std::move(solve).finish();
}

}  // namespace relume
