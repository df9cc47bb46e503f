// SPDX-License-Identifier: MIT
#include "core/methods/methods.h"

namespace relume {

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names{"bounces",   "ambient",        "chebyshev", "cg",
                                              "bicgstab",  "gauss-seidel",   "sor",       "shooting",
                                              "two-level", "two-level-gmres"};
  return names;
}

SceneLevels scene_levels(Method method, const Model& model, const SenderMatrix& bounce_matrix) {
  SceneLevels levels;
  if (method == Method::two_level) levels.rooms = correction_rooms(model, bounce_matrix);
  if (method == Method::two_level_gmres)
    levels.near_and_far = near_and_far(bounce_matrix, cluster_areas(model));
  return levels;
}

Result<Solution> solve_by(Method method, const BounceProblem& problem, const SceneLevels& levels,
                          const StopRule& rule, const BounceObserver& observer) {
  switch (method) {
    case Method::bounces:
      return solve_by_bounces(problem, rule, observer);
    case Method::ambient:
      return solve_with_ambient_start(problem, rule, observer);
    case Method::chebyshev:
      return solve_by_chebyshev(problem, safe_interval(problem), rule, observer);
    case Method::conjugate_gradients:
      return solve_by_conjugate_gradients(problem, rule, observer);
    case Method::bicgstab:
      return solve_by_bicgstab(problem, rule, observer);
    case Method::gauss_seidel:
      return solve_by_over_relaxation(problem, Rgb(1.0), rule, observer);
    case Method::over_relaxation:
      return solve_by_over_relaxation(problem, over_relaxation(problem), rule, observer);
    case Method::shooting:
      return solve_by_shooting(problem, rule, observer);
    case Method::two_level:
      return solve_by_two_levels(problem, levels.rooms, rule, observer);
    case Method::two_level_gmres:
      return solve_by_gmres(problem, levels.near_and_far, rule, observer);
  }
  return fail(ErrorCode::usage, "unknown method");
}

}  // namespace relume
