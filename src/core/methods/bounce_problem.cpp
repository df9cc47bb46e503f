// SPDX-License-Identifier: MIT
#include "core/methods/bounce_problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace relume {

Result<BounceProblem> make_bounce_problem(const SenderMatrix& matrix, const Lighting& lighting,
                                          std::vector<double> areas) {
  if (auto fits = check_shapes(matrix, lighting); !fits) return tl::unexpected(fits.error());
  if (areas.size() != matrix.rows.rows ||
      std::any_of(areas.begin(), areas.end(), [](double a) { return !(a > 0.0); }))
    return fail(ErrorCode::check_failed,
                fmt::format("areas: expected one above 0 for each of {} clusters, found {}", matrix.rows.rows,
                            areas.size() == matrix.rows.rows ? "one that is not"
                                                             : fmt::format("{} areas", areas.size())));
  BounceProblem problem{
      &matrix, lighting.albedo, {}, std::move(areas), contraction_bound(matrix, lighting.albedo)};
  if (auto checked = check_contraction(problem.contraction); !checked) return tl::unexpected(checked.error());
  problem.source = bounce(matrix, lighting, std::vector<Rgb>(problem.size(), Rgb(0.0)));
  return problem;
}

std::vector<double> cluster_areas(const Model& model) {
  std::vector<double> areas;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) areas.push_back(cluster.area);
  }
  return areas;
}

}  // namespace relume
