// SPDX-License-Identifier: MIT
#include <functional>
#include <utility>

#include "core/methods/certified_solve.h"
#include "core/methods/methods.h"
#include "core/methods/rgb_vectors.h"
#include "core/methods/room_correction.h"

namespace relume {
namespace {

/// (1 - rho K) x
std::vector<Rgb> remainder(CertifiedSolve& solve, const std::vector<Rgb>& x) {
  std::vector<Rgb> result = solve.irradiance(x);
  for (std::size_t i = 0; i < x.size(); ++i) result[i] = x[i] - solve.problem().albedo[i] * result[i];
  return result;
}

using Precondition = std::function<std::vector<Rgb>(const std::vector<Rgb>&)>;

std::vector<Rgb> iterate(CertifiedSolve& solve, const Precondition& precondition, std::vector<Rgb> x) {
  std::vector<Rgb> r = difference(solve.bounce(x), x);
  const Rgb size = largest_size(r);
  r = divided(r, size);
  const std::vector<Rgb> shadow = r;
  std::vector<Rgb> p = r;
  Rgb rho = dot(shadow, r);
  StallWatch watch;
  while (solve.products_left() > 2 && !solve.would_do(scaled(size, r)) && !watch.stalls(dot(r, r))) {
    const std::vector<Rgb> step = precondition(p);
    const std::vector<Rgb> v = remainder(solve, step);
    const Rgb alpha = quotient_or_zero(rho, dot(shadow, v));
    add_scaled(alpha * size, step, x);
    add_scaled(-alpha, v, r);
    if (solve.would_do(scaled(size, r))) break;
    const std::vector<Rgb> second_step = precondition(r);
    const std::vector<Rgb> t = remainder(solve, second_step);
    const Rgb omega = quotient_or_zero(dot(t, r), dot(t, t));
    add_scaled(omega * size, second_step, x);
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
  const auto as_it_is = [](const std::vector<Rgb>& r) { return r; };
  return restart_while_it_helps(solve, "BiCGSTAB",
                                [&](std::vector<Rgb> x) { return iterate(solve, as_it_is, std::move(x)); });
}

Result<Solution> solve_by_bicgstab_over_rooms(const BounceProblem& problem, const Rooms& rooms,
                                              const StopRule& rule, const BounceObserver& observer) {
  return solve_by_bicgstab_over_rooms(problem, room_weights(*problem.matrix, problem.areas, rooms), rule,
                                      observer);
}

Result<Solution> solve_by_bicgstab_over_rooms(const BounceProblem& problem, const RoomWeights& weights,
                                              const StopRule& rule, const BounceObserver& observer) {
  CertifiedSolve solve(problem, rule, observer);
  const RoomSolver solver(weights, problem.albedo);
  const auto correct = [&](std::vector<Rgb> r) {
    add_correction(weights.rooms, problem.albedo, solver.irradiance(r), r);
    return r;
  };
  return restart_while_it_helps(solve, "BiCGSTAB over rooms",
                                [&](std::vector<Rgb> x) { return iterate(solve, correct, std::move(x)); });
}

}  // namespace relume
