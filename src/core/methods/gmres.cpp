// SPDX-License-Identifier: MIT
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <string>
#include <utility>

#include "core/methods/certified_solve.h"
#include "core/methods/methods.h"
#include "core/methods/rgb_vectors.h"

namespace relume {
namespace {

/// A run keeps so many vectors.
constexpr std::size_t kMostVectors = 40;

/// The least-squares problem of a run, per channel: its columns by Givens rotations, as they come.
class SmallProblem {
 public:
  explicit SmallProblem(const Rgb& size) : right_{size} {}

  /// `column`: k + 1 entries of the k-th column. Returns what the residual keeps of its last value and takes
  /// of the next vector.
  std::pair<Rgb, Rgb> add(std::vector<Rgb> column) {
    const std::size_t k = rotations_.size();
    for (std::size_t i = 0; i < k; ++i) rotate(rotations_[i], column[i], column[i + 1]);
    const Rgb size = glm::sqrt(column[k] * column[k] + column[k + 1] * column[k + 1]);
    Rotation rotation{quotient_or_zero(column[k], size), quotient_or_zero(column[k + 1], size)};
    rotate(rotation, column[k], column[k + 1]);
    column.pop_back();
    right_.emplace_back(0.0);
    rotate(rotation, right_[k], right_[k + 1]);
    columns_.push_back(std::move(column));
    rotations_.push_back(rotation);
    return {rotation.sine * rotation.sine, rotation.cosine * right_[k + 1]};
  }

  std::vector<Rgb> solve() const {
    std::vector<Rgb> y(columns_.size());
    for (std::size_t k = y.size(); k-- > 0;) {
      Rgb rest = right_[k];
      for (std::size_t j = k + 1; j < y.size(); ++j) rest -= columns_[j][k] * y[j];
      y[k] = quotient_or_zero(rest, columns_[k][k]);
    }
    return y;
  }

 private:
  struct Rotation {
    Rgb cosine, sine;
  };
  static void rotate(const Rotation& rotation, Rgb& a, Rgb& b) {
    const Rgb rotated = rotation.cosine * a + rotation.sine * b;
    b = rotation.cosine * b - rotation.sine * a;
    a = rotated;
  }

  std::vector<std::vector<Rgb>> columns_;
  std::vector<Rotation> rotations_;
  std::vector<Rgb> right_;
};

Rgb area_dot(const std::vector<double>& areas, const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  Rgb sum(0.0);
  for (std::size_t i = 0; i < a.size(); ++i) sum += areas[i] * a[i] * b[i];
  return sum;
}

/// Takes from `w` what it has of the vectors before; returns their shares and the size of what is left.
std::vector<Rgb> orthogonalize(const std::vector<double>& areas, const std::vector<std::vector<Rgb>>& basis,
                               std::vector<Rgb>& w) {
  std::vector<Rgb> column;
  for (const std::vector<Rgb>& v : basis) {
    column.push_back(area_dot(areas, w, v));
    add_scaled(-column.back(), v, w);
  }
  column.push_back(glm::sqrt(area_dot(areas, w, w)));
  return column;
}

std::vector<Rgb> iterate(CertifiedSolve& solve, const NearAndFarSolver& levels, std::vector<Rgb> x) {
  const std::vector<double>& areas = solve.problem().areas;
  std::vector<Rgb> residual = difference(solve.bounce(x), x);
  const Rgb size = glm::sqrt(area_dot(areas, residual, residual));
  residual = divided(residual, size);
  std::vector<std::vector<Rgb>> basis{residual};
  SmallProblem problem(Rgb(1.0));
  while (solve.products_left() > 1 && basis.size() < kMostVectors &&
         !solve.would_do(scaled(size, residual))) {
    std::vector<Rgb> w = solve.remainder(levels.solve(basis.back()));
    std::vector<Rgb> column = orthogonalize(areas, basis, w);
    basis.push_back(divided(w, column.back()));
    const auto [kept, taken] = problem.add(std::move(column));
    residual = scaled(kept, residual);
    add_scaled(taken, basis.back(), residual);
  }
  std::vector<Rgb> step(x.size(), Rgb(0.0));
  const std::vector<Rgb> y = problem.solve();
  for (std::size_t k = 0; k < y.size(); ++k) add_scaled(size * y[k], basis[k], step);
  add_scaled(Rgb(1.0), levels.solve(step), x);
  return x;
}

}  // namespace

Result<Solution> solve_by_gmres(const BounceProblem& problem, const NearAndFar& levels, const StopRule& rule,
                                const BounceObserver& observer) {
  if (levels.near.rows != problem.size()) {
    return fail(ErrorCode::usage, "GMRES: expected levels of " + std::to_string(problem.size()) +
                                      " clusters, found levels of " + std::to_string(levels.near.rows));
  }
  CertifiedSolve solve(problem, rule, observer);
  const NearAndFarSolver solver(levels, problem.albedo);
  return restart_while_it_helps(solve, "GMRES",
                                [&](std::vector<Rgb> x) { return iterate(solve, solver, std::move(x)); });
}

}  // namespace relume
