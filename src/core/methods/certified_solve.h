// SPDX-License-Identifier: MIT
//
// What all methods share: products are counted, iterates are certified, and a method that fails gives way to
// bounces.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/certificate.h"
#include "core/methods/bounce_problem.h"

namespace relume {

/// Keeps the best answer so far of one solve. The answer is never an iterate itself but its plain bounce,
/// with what is below zero set to zero: that is closer to the solution in the weights of ContractionBound, by
/// q and because the solution is not negative, and the change of the bounce bounds its error. Channels are
/// kept apart, since they do not touch each other.
class CertifiedSolve {
 public:
  CertifiedSolve(const BounceProblem& problem, const StopRule& rule, const BounceObserver& observer);

  /// K x. Counts as a product.
  std::vector<Rgb> irradiance(const std::vector<Rgb>& x);

  /// (1 - rho K) x. Counts as a product.
  std::vector<Rgb> remainder(const std::vector<Rgb>& x);

  /// S + rho K x, certified. Counts as a product.
  std::vector<Rgb> bounce(const std::vector<Rgb>& x);

  /// Something as dear as a product was done without one.
  void count_product();

  /// The bound is within the tolerance, no product is left, or the observer said stop. Of a product by other
  /// hands also: the change is within what it rounds, which the bound then leaves out.
  bool done() const;

  /// The tolerance is reached when the change of a bounce is as small as `change` everywhere, in the weights
  /// of the contraction.
  bool would_do(const std::vector<Rgb>& change) const;

  /// max |r_j| / v_j of the last bounce per channel: infinite where it is not finite.
  const Rgb& weighted_change() const { return last_change_.weighted; }

  /// The same of what the last bounce may have rounded.
  const Rgb& rounding() const { return last_change_.rounding; }
  /// Of the best answer so far.
  const Rgb& best_weighted_change() const { return best_change_.weighted; }
  const std::vector<Rgb>& best() const { return solution_.radiosity; }
  double error_bound() const { return solution_.error_bound; }
  /// 0 once the observer said stop.
  std::uint32_t products_left() const;
  const BounceProblem& problem() const { return problem_; }

  /// The best answer, as it is.
  Result<Solution> finish() &&;

  /// Goes on from the best answer with plain bounces until the rule is met. `why`: "METHOD ...", kept in the
  /// solution.
  Result<Solution> fall_back(std::string why) &&;

 private:
  std::vector<Rgb> product(const std::vector<Rgb>& x) const;
  Change change_of(const std::vector<Rgb>& before, const std::vector<Rgb>& after) const;
  bool within_rounding() const;
  void keep_better(const std::vector<Rgb>& bounced);

  const BounceProblem& problem_;
  const StopRule& rule_;
  const BounceObserver& observer_;
  Solution solution_;
  Change best_change_;
  Change last_change_;
  bool cancelled_ = false;
};

/// For methods whose residual comes from a recurrence, which drifts from the true one. `iterate` starts from
/// what it is given, and returns when its residual would do, it makes no progress, or one product is left,
/// which certifies what it returned. It is run again from the best answer while each run halves the bound;
/// then bounces go on.
Result<Solution> restart_while_it_helps(CertifiedSolve& solve, const std::string& method,
                                        const std::function<std::vector<Rgb>(std::vector<Rgb>)>& iterate);

/// Tells a recurrence that stands still.
class StallWatch {
 public:
  /// True when no channel of `residual` has been below its lowest by a hundredth for some steps.
  bool stalls(const Rgb& residual);

 private:
  static constexpr int kPatience = 40;
  Rgb lowest_{std::numeric_limits<double>::infinity()};
  int steps_without_fall_ = 0;
};

}  // namespace relume
