// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <glm/exponential.hpp>
#include <utility>

#include "core/methods/certified_solve.h"
#include "core/methods/methods.h"
#include "core/methods/rgb_vectors.h"

namespace relume {
namespace {

Result<void> check_symmetry(const BounceProblem& problem, double max_defect) {
  if (problem.matrix->nodes.rows > 0) {
    return fail(
        ErrorCode::check_failed,
        fmt::format(
            "conjugate gradients need rows of leaves, since they need a symmetric matrix; found {} tree "
            "nodes among the senders",
            problem.matrix->nodes.rows));
  }
  const double defect = symmetry_defect(problem.matrix->rows, problem.areas);
  if (defect <= max_defect) return {};
  return fail(
      ErrorCode::check_failed,
      fmt::format(
          "conjugate gradients need a symmetric matrix: expected area x form factor to differ from its "
          "transpose by at most {:.3g} of its sum, found {:.3g}",
          max_defect, defect));
}

/// x scaled from radiosity to the symmetric unknown and back; black clusters are zero in both.
std::vector<Rgb> root_weights(const BounceProblem& problem) {
  std::vector<Rgb> roots(problem.size());
  for (std::size_t i = 0; i < roots.size(); ++i) roots[i] = glm::sqrt(problem.albedo[i] / problem.areas[i]);
  return roots;
}

std::vector<Rgb> times(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  std::vector<Rgb> result = a;
  for (std::size_t i = 0; i < a.size(); ++i) result[i] *= b[i];
  return result;
}

/// Iterations from `start` until the recurrence says that a bounce would change nothing worth mentioning.
std::vector<Rgb> iterate(CertifiedSolve& solve, const std::vector<Rgb>& roots, std::vector<Rgb> x) {
  const std::vector<double>& areas = solve.problem().areas;
  // r = (bounced - x) / roots, written without the division: A roots (H of x) - y.
  const std::vector<Rgb> change = difference(solve.bounce(x), x);
  std::vector<Rgb> r(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) r[i] = quotient_or_zero(change[i], roots[i]);
  const Rgb size = largest_size(r);
  r = divided(r, size);
  std::vector<Rgb> p = r;
  Rgb rr = dot(r, r);
  StallWatch watch;
  while (solve.products_left() > 1 && !solve.would_do(scaled(size, times(roots, r))) && !watch.stalls(rr)) {
    std::vector<Rgb> product = solve.irradiance(times(roots, p));
    for (std::size_t i = 0; i < x.size(); ++i) product[i] = p[i] - areas[i] * roots[i] * product[i];
    const Rgb alpha = quotient_or_zero(rr, dot(p, product));
    add_scaled(alpha * size, times(roots, p), x);
    add_scaled(-alpha, product, r);
    const Rgb next = dot(r, r);
    const Rgb beta = quotient_or_zero(next, rr);
    for (std::size_t i = 0; i < x.size(); ++i) p[i] = r[i] + beta * p[i];
    rr = next;
  }
  return x;
}

}  // namespace

Result<Solution> solve_by_conjugate_gradients(const BounceProblem& problem, const StopRule& rule,
                                              const BounceObserver& observer, double max_defect) {
  if (auto checked = check_symmetry(problem, max_defect); !checked) return tl::unexpected(checked.error());
  CertifiedSolve solve(problem, rule, observer);
  const std::vector<Rgb> roots = root_weights(problem);
  return restart_while_it_helps(solve, "conjugate gradients",
                                [&](std::vector<Rgb> x) { return iterate(solve, roots, std::move(x)); });
}

}  // namespace relume
