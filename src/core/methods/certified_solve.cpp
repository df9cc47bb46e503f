// SPDX-License-Identifier: MIT
#include "core/methods/certified_solve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "core/methods/rgb_vectors.h"
#include "core/sender_product.h"

namespace relume {

CertifiedSolve::CertifiedSolve(const BounceProblem& problem, const StopRule& rule,
                               const BounceObserver& observer)
    : problem_(problem), rule_(rule), observer_(observer) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  solution_.radiosity = problem.source;
  solution_.error_bound = kUnknown;
  best_change_ = {Rgb(kUnknown), Rgb(kUnknown), Rgb(0.0)};
  last_change_ = best_change_;
}

void CertifiedSolve::count_product() {
  ++solution_.bounces;
  if (observer_ && !observer_(solution_.bounces, solution_.error_bound)) cancelled_ = true;
}

std::vector<Rgb> CertifiedSolve::irradiance(const std::vector<Rgb>& x) {
  std::vector<Rgb> result = product(x);
  count_product();
  return result;
}

std::vector<Rgb> CertifiedSolve::remainder(const std::vector<Rgb>& x) {
  std::vector<Rgb> result = irradiance(x);
  for (std::size_t i = 0; i < x.size(); ++i) result[i] = x[i] - problem_.albedo[i] * result[i];
  return result;
}

std::vector<Rgb> CertifiedSolve::product(const std::vector<Rgb>& x) const {
  return problem_.product ? problem_.product(x) : cluster_product(*problem_.matrix, x);
}

Change CertifiedSolve::change_of(const std::vector<Rgb>& before, const std::vector<Rgb>& after) const {
  if (!problem_.product) return measure_change(*problem_.matrix, problem_.contraction, before, after);
  return measure_change(problem_.contraction, problem_.product_rounding, before, after);
}

bool CertifiedSolve::within_rounding() const {
  if (!problem_.product) return false;
  for (int channel = 0; channel < 3; ++channel) {
    if (best_change_.weighted[channel] > best_change_.rounding[channel]) return false;
  }
  return true;
}

std::vector<Rgb> CertifiedSolve::bounce(const std::vector<Rgb>& x) {
  std::vector<Rgb> bounced = product(x);
  for (std::size_t i = 0; i < bounced.size(); ++i)
    bounced[i] = problem_.source[i] + problem_.albedo[i] * bounced[i];
  last_change_ = change_of(x, bounced);
  keep_better(bounced);
  count_product();
  return bounced;
}

void CertifiedSolve::keep_better(const std::vector<Rgb>& bounced) {
  for (int channel = 0; channel < 3; ++channel) {
    const bool better = last_change_.weighted[channel] <= best_change_.weighted[channel];
    if (!better || !std::isfinite(last_change_.weighted[channel])) continue;
    best_change_.largest[channel] = last_change_.largest[channel];
    best_change_.weighted[channel] = last_change_.weighted[channel];
    best_change_.rounding[channel] = last_change_.rounding[channel];
    for (std::size_t i = 0; i < bounced.size(); ++i)
      solution_.radiosity[i][channel] = std::max(bounced[i][channel], 0.0);
  }
  Change rated = best_change_;
  if (problem_.product) rated.rounding = Rgb(0.0);
  rate_solution(rated, problem_.contraction.quotient, problem_.contraction.quotient, solution_);
}

bool CertifiedSolve::done() const {
  const bool reached = rule_.tolerance > 0.0 && solution_.error_bound <= rule_.tolerance;
  return cancelled_ || reached || within_rounding() || solution_.bounces >= rule_.max_bounces;
}

std::uint32_t CertifiedSolve::products_left() const {
  if (cancelled_ || solution_.bounces >= rule_.max_bounces) return 0;
  return rule_.max_bounces - solution_.bounces;
}

bool CertifiedSolve::would_do(const std::vector<Rgb>& change) const {
  Change expected;
  for (std::size_t i = 0; i < change.size(); ++i)
    expected.weighted = glm::max(expected.weighted, glm::abs(change[i]) / problem_.contraction.weights[i]);
  Solution rated;
  rated.radiosity = solution_.radiosity;
  rate_solution(expected, problem_.contraction.quotient, problem_.contraction.quotient, rated);
  return rated.error_bound <= rule_.tolerance;
}

Result<Solution> CertifiedSolve::finish() && {
  if (cancelled_)
    return fail(ErrorCode::cancelled, fmt::format("cancelled after {} products", solution_.bounces));
  return std::move(solution_);
}

Result<Solution> CertifiedSolve::fall_back(std::string why) && {
  if (!done()) {
    solution_.fallback = fmt::format("{}; plain bounces went on after {} products", why, solution_.bounces);
    std::vector<Rgb> x = solution_.radiosity;
    while (!done()) x = bounce(x);
  }
  return std::move(*this).finish();
}

Result<Solution> restart_while_it_helps(CertifiedSolve& solve, const std::string& method,
                                        const std::function<std::vector<Rgb>(std::vector<Rgb>)>& iterate) {
  constexpr double kLeastGain = 0.5;
  std::vector<Rgb> x = solve.problem().source;
  while (!solve.done()) {
    const double before = solve.error_bound();
    x = iterate(std::move(x));
    if (solve.done()) break;
    clamp_at_zero(x);
    solve.bounce(x);
    if (!solve.done() && !(solve.error_bound() <= kLeastGain * before))
      return std::move(solve).fall_back(method + " stalled");
    x = solve.best();
  }
  return std::move(solve).finish();
}

bool StallWatch::stalls(const Rgb& residual) {
  constexpr double kFall = 0.99;
  bool fell = false;
  for (int channel = 0; channel < 3; ++channel) {
    if (!(residual[channel] < kFall * lowest_[channel])) continue;
    lowest_[channel] = residual[channel];
    fell = true;
  }
  steps_without_fall_ = fell ? 0 : steps_without_fall_ + 1;
  return steps_without_fall_ >= kPatience;
}

}  // namespace relume
