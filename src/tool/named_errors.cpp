// SPDX-License-Identifier: MIT
#include "tool/named_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/light_patches.h"
#include "measure/statistics.h"
#include "precompute/direct_irradiance.h"
#include "precompute/row_plan.h"

namespace relume {
namespace {

/// A number of the object `estimated` among the options that the file records.
std::optional<double> estimated(const Model& model, const char* cause) {
  const auto options = nlohmann::json::parse(model.provenance.options, nullptr, /*allow_exceptions=*/false);
  if (!options.is_object() || !options.contains("estimated")) return {};
  const auto& numbers = options["estimated"];
  if (!numbers.is_object() || !numbers.contains(cause) || !numbers[cause].is_number()) return {};
  return numbers[cause].get<double>();
}

double worst_precision(const Model& model) {
  double worst = 0.0;
  for (const System& system : model.systems) {
    for (const BlockMatrix* matrix : {&system.bounce, &system.gather}) {
      for (const MatrixBlock& block : matrix->blocks) worst = std::max(worst, precision_error(block.codec));
    }
  }
  return worst;
}

Result<double> light_error(const Model& model, const LightingSetup& setup, const SolveOutcome& outcome) {
  const auto direct = direct_irradiance(model, setup.lights, 0, kPatchesPerElement / 4.0);
  if (!direct) return tl::unexpected(direct.error());
  Lighting lighting = setup.lighting;
  lighting.direct = direct->clusters;
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto solution = solve_reference(matrices.bounce, lighting, {outcome.solution.bounces + 1, 1e-5});
  if (!solution) return tl::unexpected(solution.error());
  return relative_difference(gather(matrices.gather, lighting, solution->radiosity), outcome.gathered);
}

std::string percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.2g} %", 100.0 * *share) : "unknown";
}

JsonValue number_or_null(const std::optional<double>& share) {
  return share ? JsonValue(*share) : JsonValue();
}

}  // namespace

Result<NamedErrors> name_errors(const Model& model, const LightingSetup& setup, const SolveOutcome& outcome) {
  NamedErrors errors;
  errors.clusters = estimated(model, "clusters");
  errors.rays = estimated(model, "rays");
  errors.cut = estimated(model, "cut");
  errors.precision = worst_precision(model);
  errors.iteration = outcome.solution.error_bound;
  if (setup.lights.empty()) return errors;
  const auto light = light_error(model, setup, outcome);
  if (!light) return tl::unexpected(light.error());
  errors.light = *light;
  return errors;
}

std::string errors_sentence(const NamedErrors& errors) {
  return fmt::format(
      "errors by cause: cluster size {}, rays {}, cut {} ({}), stored values {:.2g} %, light {}, iteration "
      "{:.2g} %",
      percent(errors.clusters), percent(errors.rays), percent(errors.cut),
      errors.clusters ? "as the precompute estimates, whatever the lights"
                      : "estimated by a precompute with --error",
      100.0 * errors.precision, errors.light ? percent(errors.light) : "none", 100.0 * errors.iteration);
}

JsonValue errors_json(const NamedErrors& errors) {
  return JsonObject{{"clusters", number_or_null(errors.clusters)}, {"rays", number_or_null(errors.rays)},
                    {"cut", number_or_null(errors.cut)},           {"precision", errors.precision},
                    {"light", number_or_null(errors.light)},       {"iteration", errors.iteration}};
}

}  // namespace relume
