// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/methods/methods.h"

namespace relume {
namespace {

/// What the second level needs as a rule; below this, plain bounces are as fast.
constexpr double kFewBounces = 12.0;

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

ScenePrediction predict(const BounceProblem& problem, const Rooms& rooms, const StopRule& rule) {
  ScenePrediction scene;
  scene.spectral_radius = problem.contraction.quotient;
  scene.closure = mean_row_sum(problem);
  const Rgb& q = scene.spectral_radius;
  const double slowest = std::max({q.x, q.y, q.z});
  scene.bounces = slowest <= 0.0 ? 1.0 : double(rule.max_bounces);
  if (slowest > 0.0 && rule.tolerance > 0.0)
    scene.bounces =
        std::min(scene.bounces, std::ceil(std::log(std::min(rule.tolerance, 1.0)) / std::log(slowest)));
  scene.rooms = rooms.count;
  double inside = 0.0, area = 0.0;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    area += problem.areas[i];
    if (rooms.of_cluster[i] != kNone) inside += problem.areas[i];
  }
  scene.share_in_rooms = area > 0.0 ? inside / area : 0.0;
  if (problem.matrix->nodes.rows == 0)
    scene.symmetry_defect = symmetry_defect(problem.matrix->rows, problem.areas);
  return scene;
}

}  // namespace

MethodChoice choose_method(const BounceProblem& problem, const Rooms& rooms, const StopRule& rule) {
  MethodChoice choice{Method::bounces, {}, predict(problem, rooms, rule)};
  if (rule.tolerance <= 0.0) {
    choice.reason = "a number of bounces was asked for";
    return choice;
  }
  const ScenePrediction& scene = choice.scene;
  const double slowest =
      std::max({scene.spectral_radius.x, scene.spectral_radius.y, scene.spectral_radius.z});
  if (scene.bounces <= kFewBounces) {
    choice.reason =
        fmt::format("the spectral radius is at most {:.3g}: {:.0f} bounces do", slowest, scene.bounces);
    return choice;
  }
  choice.method = scene.rooms > 0 ? Method::two_level_bicgstab : Method::bicgstab;
  choice.reason = fmt::format(
      "the spectral radius is up to {:.3g}, so bounces would take {:.0f}; the matrix {}; {} rooms hold "
      "{:.0f} % of the area",
      slowest, scene.bounces,
      scene.symmetry_defect ? fmt::format("has a symmetry defect of {:.2g}", *scene.symmetry_defect)
                            : "has nodes",
      scene.rooms, 100.0 * scene.share_in_rooms);
  return choice;
}

}  // namespace relume
