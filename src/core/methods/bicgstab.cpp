// SPDX-License-Identifier: MIT
#include <utility>

#include "core/methods/certified_solve.h"
#include "core/methods/methods.h"
#include "core/methods/rgb_vectors.h"

namespace relume {
namespace {

std::vector<Rgb> iterate(CertifiedSolve& solve, std::vector<Rgb> x) {
  std::vector<Rgb> r = difference(solve.bounce(x), x);
  const Rgb size = largest_size(r);
  r = divided(r, size);
  const std::vector<Rgb> shadow = r;
  std::vector<Rgb> p = r;
  Rgb rho = dot(shadow, r);
  StallWatch watch;
  while (solve.products_left() > 2 && !solve.would_do(scaled(size, r)) && !watch.stalls(dot(r, r))) {
    const std::vector<Rgb> v = solve.remainder(p);
    const Rgb alpha = quotient_or_zero(rho, dot(shadow, v));
    add_scaled(alpha * size, p, x);
    add_scaled(-alpha, v, r);
    if (solve.would_do(scaled(size, r))) break;
    const std::vector<Rgb> t = solve.remainder(r);
    const Rgb omega = quotient_or_zero(dot(t, r), dot(t, t));
    add_scaled(omega * size, r, x);
    add_scaled(-omega, t, r);
    const Rgb next = dot(shadow, r);
    const Rgb beta = quotient_or_zero(next, rho) * quotient_or_zero(alpha, omega);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = r[i] + beta * (p[i] - omega * v[i]);
    rho = next;
  }
  return x;
}

}  // namespace

Result<Solution> solve_by_bicgstab(const BounceProblem& problem, const StopRule& rule,
                                   const BounceObserver& observer) {
  CertifiedSolve solve(problem, rule, observer);
  return restart_while_it_helps(solve, "BiCGSTAB",
                                [&](std::vector<Rgb> x) { return iterate(solve, std::move(x)); });
}

}  // namespace relume
