// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/methods/methods.h"

namespace relume {
namespace {

/// As many products as BiCGSTAB needs at least; below this, plain bounces are as fast.
constexpr double kFewBounces = 12.0;
/// To find the two levels costs about as much as 50 products, after which GMRES needs 5 to 20. BiCGSTAB needs
/// about a quarter of the bounces in furnished scenes.
constexpr double kManyBounces = 250.0;

double mean_row_sum(const BounceProblem& problem) {
  const CsrMatrix& rows = problem.matrix->rows;
  double sum = 0.0, area = 0.0;
  for (std::uint32_t row = 0; row < rows.rows; ++row) {
    double row_sum = 0.0;
    for (std::uint64_t e = rows.row_offsets[row]; e < rows.row_offsets[row + 1]; ++e) {
      const std::uint32_t column = rows.column_indices[e];
      const bool sky = column >= rows.rows && column < rows.columns - problem.matrix->nodes.rows;
      if (!sky) row_sum += rows.values[e];
    }
    sum += problem.areas[row] * row_sum;
    area += problem.areas[row];
  }
  return area > 0.0 ? sum / area : 0.0;
}

ScenePrediction predict(const BounceProblem& problem, double tolerance) {
  ScenePrediction scene;
  scene.spectral_radius = problem.contraction.quotient;
  scene.closure = mean_row_sum(problem);
  const Rgb& q = scene.spectral_radius;
  const double slowest = std::max({q.x, q.y, q.z});
  scene.bounces = slowest <= 0.0 ? 1.0 : std::ceil(std::log(std::min(tolerance, 0.5)) / std::log(slowest));
  if (problem.matrix->nodes.rows == 0)
    scene.symmetry_defect = symmetry_defect(problem.matrix->rows, problem.areas);
  return scene;
}

}  // namespace

MethodChoice choose_method(const BounceProblem& problem, const StopRule& rule) {
  if (rule.tolerance <= 0.0) return {Method::bounces, "a number of bounces was asked for", {}};
  MethodChoice choice{Method::bounces, {}, predict(problem, rule.tolerance)};
  const ScenePrediction& scene = *choice.scene;
  const Rgb& q = scene.spectral_radius;
  const std::string radius = fmt::format("the spectral radius is up to {:.4g}", std::max({q.x, q.y, q.z}));
  if (scene.bounces <= kFewBounces) {
    choice.reason = fmt::format("{}: {:.0f} bounces do", radius, scene.bounces);
    return choice;
  }
  choice.method = scene.bounces <= kManyBounces ? Method::bicgstab : Method::two_level_gmres;
  const std::string symmetry =
      scene.symmetry_defect
          ? fmt::format("the matrix differs from symmetry by {:.2g}", *scene.symmetry_defect)
          : "the matrix has tree nodes";
  choice.reason = fmt::format(
      "{}, so bounces could take {:.0f}; {}, so conjugate gradients are {}", radius, scene.bounces, symmetry,
      scene.symmetry_defect.value_or(2.0) <= kMaxSymmetryDefect ? "not needed" : "not safe");
  return choice;
}

}  // namespace relume
