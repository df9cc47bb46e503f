// SPDX-License-Identifier: MIT
#include "tool/solution_bounds.h"

#include <fmt/format.h>

#include <algorithm>

#include "tool/interrupt.h"

namespace relume {
namespace {

/// Of valid lumels with light, ascending.
std::vector<double> lumel_widths(const Model& model, const SolveOutcome& outcome, const Bracket& irradiance) {
  const std::vector<double> of_rows = relative_widths(irradiance, outcome.gathered);
  const auto first_row = gather_offsets(model);
  std::vector<double> widths;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const std::vector<Lumel>& lumels = model.systems[s].lumels;
    for (std::size_t l = 0; l < lumels.size(); ++l) {
      const std::size_t row = first_row[s] + l;
      const bool lit = outcome.gathered[row] != Rgb(0.0);
      if (lit && (lumels[l].flags & kLumelInvalid) == 0) widths.push_back(of_rows[row]);
    }
  }
  std::sort(widths.begin(), widths.end());
  return widths;
}

}  // namespace

Result<SolutionBounds> bound_solution(const Model& model, const Lighting& lighting,
                                      const SolveOutcome& outcome, Console& console) {
  Result<SolutionBracket> bracket =
      bracket_solution(loose_matrices(model), lighting, outcome.solution.radiosity, [&console] {
        console.progress("bounds", 0.0);
        return !interrupted();
      });
  console.end_progress();
  if (!bracket) return tl::unexpected(bracket.error());
  SolutionBounds bounds;
  const std::vector<double> widths = lumel_widths(model, outcome, bracket->irradiance);
  bounds.bracket = std::move(*bracket);
  if (!widths.empty()) {
    bounds.median_width = widths[widths.size() / 2];
    bounds.widest = widths[widths.size() * 95 / 100];
  }
  return bounds;
}

std::string bounds_sentence(const SolutionBounds& bounds) {
  return fmt::format(
      "bounds on what cut, stored values and iteration change: {:.3g} % of a lumel's value from least to "
      "most "
      "(median), {:.3g} % or less at 95 of 100 lumels",
      100.0 * bounds.median_width, 100.0 * bounds.widest);
}

JsonValue bounds_json(const SolutionBounds& bounds) {
  return JsonObject{{"median_width", bounds.median_width},
                    {"width_of_95_percent", bounds.widest},
                    {"products", bounds.bracket.products}};
}

}  // namespace relume
