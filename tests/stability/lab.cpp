// SPDX-License-Identifier: MIT
#include "stability/lab.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/methods/room_correction.h"

namespace relume::test {
namespace {

/// rho K P, with the sky left out.
Eigen::MatrixXd dense_reflection(const SenderMatrix& matrix, const Lighting& lighting) {
  const Eigen::Index n = matrix.rows.rows;
  const std::uint32_t leaves = matrix.rows.columns - matrix.nodes.rows;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  for (std::uint32_t row = 0; row < matrix.rows.rows; ++row) {
    const double albedo = lighting.albedo[row].x;
    for (auto e = matrix.rows.row_offsets[row]; e < matrix.rows.row_offsets[row + 1]; ++e) {
      const std::uint32_t column = matrix.rows.column_indices[e];
      const double value = albedo * matrix.rows.values[e];
      if (column < matrix.rows.rows) dense(row, column) += value;
      if (column < leaves) continue;
      for (auto k = matrix.nodes.row_offsets[column - leaves];
           k < matrix.nodes.row_offsets[column - leaves + 1]; ++k)
        dense(row, matrix.nodes.column_indices[k]) += value * matrix.nodes.values[k];
    }
  }
  return dense;
}

}  // namespace

std::vector<double> dense_solution(const SenderMatrix& matrix, const Lighting& lighting) {
  const Eigen::Index n = matrix.rows.rows;
  Eigen::VectorXd source(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    source(i) = lighting.exitance[row].x + lighting.albedo[row].x * lighting.direct[row].x;
  }
  const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(n, n) - dense_reflection(matrix, lighting);
  const Eigen::VectorXd b = left.partialPivLu().solve(source);
  return {b.begin(), b.end()};
}

double power_method(const SenderMatrix& matrix, const Lighting& lighting) {
  const Eigen::MatrixXd dense = dense_reflection(matrix, lighting);
  Eigen::VectorXd v = Eigen::VectorXd::Ones(dense.rows());
  double growth = 0.0;
  for (int step = 0; step < 4000; ++step) {
    const Eigen::VectorXd next = 0.5 * (dense * v + v);  // modes of equal size and other sign die away
    growth = next.norm() / v.norm();
    v = next / next.norm();
  }
  return 2.0 * growth - 1.0;
}

Outcome judge(const Case& c, const Result<Solution>& solution, const StopRule& rule) {
  if (!solution) return {OutcomeKind::refused, 0, solution.error().message};
  Outcome outcome{OutcomeKind::wrong, solution->bounces, solution->fallback};
  if (c.exact.empty() || solution->bounces > rule.max_bounces) return outcome;
  double largest = 0.0, error = 0.0;
  for (std::size_t i = 0; i < c.exact.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      const double found = solution->radiosity[i][channel];
      if (!std::isfinite(found) || found < 0.0) return outcome;
    }
    largest = std::max(largest, solution->radiosity[i].x);
    error = std::max(error, std::abs(solution->radiosity[i].x - c.exact[i]));
  }
  // The oracle rounds as well.
  const double oracle = 1e-10 * largest;
  if (!(solution->error_bound >= 0.0) || error > solution->error_bound * largest + oracle) return outcome;
  if (solution->error_bound <= rule.tolerance) {
    outcome.kind = solution->fallback.empty() ? OutcomeKind::right : OutcomeKind::fell_back;
  } else if (solution->bounces == rule.max_bounces) {
    outcome.kind = OutcomeKind::bounded;
  }
  return outcome;
}

Outcome run_method(const Case& c, Method method) {
  const Result<BounceProblem> problem = make_bounce_problem(c.matrix, c.lighting, c.areas);
  if (!problem) return {OutcomeKind::refused, 0, problem.error().message};
  SceneLevels levels{c.rooms, {}};
  if (method == Method::two_level_gmres) levels.near_and_far = near_and_far(c.matrix, c.areas);
  return judge(c, solve_by(method, *problem, levels, kLabRule), kLabRule);
}

std::string describe(const Outcome& outcome) {
  switch (outcome.kind) {
    case OutcomeKind::right:
      return std::to_string(outcome.products);
    case OutcomeKind::fell_back:
      return std::to_string(outcome.products) + " fb";
    case OutcomeKind::bounded:
      return "bound";
    case OutcomeKind::refused:
      return "refused";
    case OutcomeKind::wrong:
      break;
  }
  return "WRONG";
}

}  // namespace relume::test
