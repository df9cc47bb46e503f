// SPDX-License-Identifier: MIT
#include "verification/whole_path.h"

#include <cmath>
#include <stdexcept>

#include "core/reference_solver.h"
#include "precompute/direct_irradiance.h"
#include "scene/surface_color.h"

namespace relume::test {
namespace {

template <class T>
T value_or_throw(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return std::move(*result);
}

}  // namespace

RunTimeLighting light(const Model& model, const Scene& scene, const LightSources& sources) {
  RunTimeLighting lit;
  lit.lighting = stored_lighting(model);
  ClusterColors colors = cluster_colors(model, scene, model.max_albedo);
  lit.lighting.albedo = std::move(colors.albedo);
  lit.lighting.exitance = std::move(colors.exitance);
  if (sources.sky) {
    lit.lighting.sky_radiosity = sky_radiosity(*sources.sky, model.sky_cells, model.sky_resolution);
  }
  DirectIrradiance direct = value_or_throw(direct_irradiance(model, sources.lights));
  lit.lighting.direct = std::move(direct.clusters);
  lit.gather_direct = std::move(direct.gather);
  return lit;
}

GatheredIrradiance solve_and_gather(const Model& model, const RunTimeLighting& lit) {
  const ReferenceMatrices matrices = reference_matrices(model);
  StopRule rule;
  rule.tolerance = 1e-6;
  const Solution solution = value_or_throw(solve_reference(matrices.bounce, lit.lighting, rule));
  return {lit.gather_direct, gather(matrices.gather, lit.lighting, solution.radiosity)};
}

std::vector<ProbeCoefficients> solve_probes(const Model& model, const RunTimeLighting& lit) {
  StopRule rule;
  rule.tolerance = 1e-6;
  const Solution solution =
      value_or_throw(solve_reference(reference_bounce_matrix(model), lit.lighting, rule));
  return probe_coefficients(model, lit.lighting, solution.radiosity);
}

std::vector<Rgb> at_sensors(const Model& model, const std::vector<Rgb>& gather_rows) {
  std::vector<Rgb> values(model.sensor_names.size());
  const auto offsets = gather_offsets(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    for (std::size_t i = 0; i < system.sensors.size(); ++i)
      values[system.sensors[i].name] = gather_rows[offsets[s] + system.lumels.size() + i];
  }
  return values;
}

Model precompute_or_throw(const Scene& scene, const PrecomputeOptions& options, PrecomputeReport* report) {
  PrecomputeReport unused;
  Model model = value_or_throw(precompute(scene, options, report != nullptr ? *report : unused));
  if (const auto checked = check_model(model); !checked) throw std::runtime_error(checked.error().message);
  return model;
}

Agreement agreement(std::span<const Rgb> values, std::span<const Rgb> truth) {
  if (values.size() != truth.size()) throw std::runtime_error("agreement: lengths differ");
  double difference = 0.0, total = 0.0, squared_difference = 0.0, squared_total = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double d = values[i][c] - truth[i][c];
      difference += d;
      total += truth[i][c];
      squared_difference += d * d;
      squared_total += truth[i][c] * truth[i][c];
    }
  }
  Agreement result{difference / total, std::sqrt(squared_difference / squared_total), 0.0, 0};
  const double floor = 0.02 * total / (3.0 * double(truth.size()));
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double relative = std::abs(values[i][c] - truth[i][c]) / (truth[i][c] + floor);
      if (relative <= result.worst) continue;
      result.worst = relative;
      result.worst_index = i;
    }
  }
  return result;
}

}  // namespace relume::test
