// SPDX-License-Identifier: MIT
#include "core/methods/methods.h"

namespace relume {

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names{"bounces",   "ambient",           "chebyshev", "cg",
                                              "bicgstab",  "gauss-seidel",      "sor",       "shooting",
                                              "two-level", "two-level-bicgstab"};
  return names;
}

Result<Solution> solve_by(Method method, const BounceProblem& problem, const Rooms& rooms,
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
      return solve_by_two_levels(problem, rooms, rule, observer);
    case Method::two_level_bicgstab:
      return solve_by_bicgstab_over_rooms(problem, rooms, rule, observer);
  }
  return fail(ErrorCode::usage, "unknown method");
}

}  // namespace relume
