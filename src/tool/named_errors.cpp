// SPDX-License-Identifier: MIT
#include "tool/named_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "core/light_patches.h"
#include "measure/statistics.h"
#include "precompute/direct_irradiance.h"
#include "precompute/row_plan.h"
#include "tool/cluster_refinement.h"

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

Result<double> light_error(const Model& model, const ReferenceMatrices& matrices, const LightingSetup& setup,
                           const SolveOutcome& outcome) {
  const auto direct = direct_irradiance(model, setup.lights, 0, kPatchesPerElement / 4.0);
  if (!direct) return tl::unexpected(direct.error());
  Lighting lighting = setup.lighting;
  lighting.direct = direct->clusters;
  const auto solution = solve_reference(matrices.bounce, lighting, {outcome.solution.bounces + 1, 1e-5});
  if (!solution) return tl::unexpected(solution.error());
  return relative_difference(gather(matrices.gather, lighting, solution->radiosity), outcome.gathered);
}

/// Of the rays, for the lights that shine, over valid lumels.
std::optional<double> ray_error(const Model& model, const SolveOutcome& outcome, const RayNoise& noise) {
  double squares = 0.0, total = 0.0;
  const auto first_row = gather_offsets(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const std::vector<Lumel>& lumels = model.systems[s].lumels;
    for (std::size_t l = 0; l < lumels.size(); ++l) {
      if ((lumels[l].flags & kLumelInvalid) != 0) continue;
      const Rgb &error = noise.irradiance[first_row[s] + l], &value = outcome.gathered[first_row[s] + l];
      squares += glm::dot(error, error);
      total += glm::dot(value, value);
    }
  }
  if (total <= 0.0) return {};
  return std::sqrt(squares / total);
}

std::string percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.2g} %", 100.0 * *share) : "unknown";
}

JsonValue number_or_null(const std::optional<double>& share) {
  return share ? JsonValue(*share) : JsonValue();
}

/// Of lists that say which leaves of a node rows see (core/halvings.h).
std::uint64_t halving_bytes(const Model& model) {
  std::uint64_t bytes = 0;
  for (const System& system : model.systems)
    bytes += system.bounce_halvings.size() + system.gather_halvings.size();
  return bytes;
}

}  // namespace

Result<NamedErrors> name_errors(const Model& model, const LightingSetup& setup, const SolveOutcome& outcome) {
  NamedErrors errors;
  const auto clusters = cluster_size_error(model, setup, outcome);
  if (!clusters) return tl::unexpected(clusters.error());
  errors.clusters = *clusters;
  errors.cut = estimated(model, "cut");
  errors.precision = worst_precision(model);
  errors.iteration = outcome.solution.error_bound;
  const ReferenceMatrices matrices = reference_matrices(model);
  errors.noise = ray_noise(model, matrices, setup.lighting, outcome.solution.radiosity);
  if (errors.noise) errors.rays = ray_error(model, outcome, *errors.noise);
  if (setup.lights.empty()) return errors;
  const auto light = light_error(model, matrices, setup, outcome);
  if (!light) return tl::unexpected(light.error());
  errors.light = *light;
  return errors;
}

std::string errors_sentence(const NamedErrors& errors) {
  const bool estimated = errors.cut.has_value();
  return fmt::format(
      "errors by cause: cluster size {} (clusters taken apart before a sample of lumels), cut {} ({}), rays "
      "{} ({}), stored values {:.2g} %, light {}, "
      "iteration "
      "{:.2g} %",
      percent(errors.clusters), percent(errors.cut),
      estimated ? "as the precompute estimates, whatever the lights"
                : "estimated by a precompute with --error",
      percent(errors.rays),
      errors.noise && errors.noise->measured ? "standard error for these lights"
                                             : "as independent rays would err; these are better",
      100.0 * errors.precision, errors.light ? percent(errors.light) : "none", 100.0 * errors.iteration);
}

std::string stored_errors_line(const Model& model) {
  const auto clusters = estimated(model, "clusters"), rays = estimated(model, "rays"),
             cut = estimated(model, "cut");
  const double precision = worst_precision(model);
  const double halvings = 1e-6 * double(halving_bytes(model));
  const std::string bounds = halvings > 0.0 ? fmt::format("{:.1f} MB kept for narrow bounds", halvings)
                                            : "nothing kept for narrow bounds (precompute --bounds)";
  if (!clusters || !rays || !cut)
    return fmt::format("errors not estimated (--error), but of stored values: {:.2g} %; {}",
                       100.0 * precision, bounds);
  const ErrorEstimate error{*clusters, *rays, *cut, precision};
  return fmt::format("estimated error {}: clusters {}, rays {}, cut {}, stored values {:.2g} %; {}",
                     percent(error.total()), percent(clusters), percent(rays), percent(cut),
                     100.0 * precision, bounds);
}

JsonValue stored_errors_json(const Model& model) {
  return JsonObject{{"clusters", number_or_null(estimated(model, "clusters"))},
                    {"rays", number_or_null(estimated(model, "rays"))},
                    {"cut", number_or_null(estimated(model, "cut"))},
                    {"precision", worst_precision(model)},
                    {"bounds_bytes", halving_bytes(model)}};
}

JsonValue errors_json(const NamedErrors& errors) {
  return JsonObject{{"clusters", number_or_null(errors.clusters)},
                    {"rays", number_or_null(errors.rays)},
                    {"rays_measured", errors.noise && errors.noise->measured},
                    {"cut", number_or_null(errors.cut)},
                    {"precision", errors.precision},
                    {"light", number_or_null(errors.light)},
                    {"iteration", errors.iteration}};
}

}  // namespace relume
