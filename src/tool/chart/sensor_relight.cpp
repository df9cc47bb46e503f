// SPDX-License-Identifier: MIT
#include "tool/chart/sensor_relight.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "tool/interrupt.h"

namespace relume {
namespace {

constexpr StopRule kOwnSolution{2000, 1e-6};

std::vector<Rgb> start(const Lighting& lighting) {
  std::vector<Rgb> radiosity = lighting.exitance;
  for (std::size_t i = 0; i < radiosity.size(); ++i) radiosity[i] += lighting.albedo[i] * lighting.direct[i];
  return radiosity;
}

CsrMatrix picked_rows(const CsrMatrix& matrix, const std::vector<std::uint32_t>& rows) {
  CsrMatrix picked{std::uint32_t(rows.size()), matrix.columns, {0}, {}, {}};
  for (const std::uint32_t row : rows) {
    const auto begin = std::ptrdiff_t(matrix.row_offsets[row]),
               end = std::ptrdiff_t(matrix.row_offsets[row + 1]);
    picked.column_indices.insert(picked.column_indices.end(), matrix.column_indices.begin() + begin,
                                 matrix.column_indices.begin() + end);
    picked.values.insert(picked.values.end(), matrix.values.begin() + begin, matrix.values.begin() + end);
    picked.row_offsets.push_back(picked.values.size());
  }
  return picked;
}

/// One light's bounces.
struct LightRun {
  std::vector<Rgb> converged, stopped;
  std::uint32_t products = 0;
  Result<void> end;
};

void run_to_convergence(const SensorMatrices& matrices, const Lighting& lighting,
                        const std::vector<std::uint32_t>& rooms, LightRun& run) {
  const auto solution = solve_reference(matrices.bounce, lighting, kOwnSolution,
                                        [](std::uint32_t, double) { return !interrupted(); });
  if (!solution) {
    run.end = tl::unexpected(solution.error());
    return;
  }
  run.converged = gather(matrices.sensors, lighting, solution->radiosity);
  std::vector<Rgb> radiosity = start(lighting);
  for (run.products = 0; run.products < kOwnSolution.max_bounces; ++run.products) {
    run.stopped = gather(matrices.sensors, lighting, radiosity);
    if (sensor_error(rooms, run.stopped, run.converged) <= kConverged) return;
    radiosity = bounce(matrices.bounce, lighting, radiosity);
  }
}

void run_bounces(const SensorMatrices& matrices, const Lighting& lighting, std::uint32_t bounces,
                 LightRun& run) {
  std::vector<Rgb> radiosity = start(lighting);
  for (std::uint32_t k = 0; k < bounces; ++k) radiosity = bounce(matrices.bounce, lighting, radiosity);
  run.stopped = gather(matrices.sensors, lighting, radiosity);
}

}  // namespace

SensorMatrices sensor_matrices(const Model& model) {
  ReferenceMatrices all = reference_matrices(model);
  CsrMatrix sensors = picked_rows(all.gather.rows, sensor_rows(model));
  return {std::move(all.bounce), {std::move(sensors), std::move(all.gather.nodes)}};
}

Result<std::vector<Lighting>> test_lightings(const Model& model, const TestScene& test) {
  std::vector<Lighting> lightings;
  for (const TestLight& light : test.lights) {
    auto lighting = test_lighting(model, light);
    if (!lighting) return tl::unexpected(lighting.error());
    lightings.push_back(std::move(*lighting));
  }
  return lightings;
}

Result<SensorRelight> relight_sensors(const SensorMatrices& matrices, const std::vector<Lighting>& lightings,
                                      const std::vector<std::uint32_t>& rooms) {
  std::vector<LightRun> runs(lightings.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t l) { run_to_convergence(matrices, lightings[l], rooms, runs[l]); });
  SensorRelight result;
  for (const LightRun& run : runs) {
    if (!run.end) return tl::unexpected(run.end.error());
    result.products = std::max(result.products, run.products);
  }
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t l) {
    if (runs[l].products != result.products) run_bounces(matrices, lightings[l], result.products, runs[l]);
  });
  for (LightRun& run : runs) {
    result.converged.push_back(std::move(run.converged));
    result.stopped.push_back(std::move(run.stopped));
  }
  return result;
}

MeasuredError measure_error(const std::vector<std::uint32_t>& rooms, const SensorValues& values,
                            const SensorValues& reference) {
  MeasuredError error;
  for (std::size_t l = 0; l < values.size(); ++l) {
    const double one = sensor_error(rooms, values[l], reference[l]);
    error.all_lights += one * one / double(values.size());
    error.worst_light = std::max(error.worst_light, one);
  }
  error.all_lights = std::sqrt(error.all_lights);
  return error;
}

std::optional<std::uint32_t> least_count(std::uint32_t most,
                                         const std::function<Result<bool>(std::uint32_t)>& is_enough,
                                         Result<void>& failure) {
  const auto enough = [&](std::uint32_t count) {
    Result<bool> found = is_enough(count);
    if (!found) failure = tl::unexpected(found.error());
    return found && *found;
  };
  std::uint32_t low = 0, high = 1;
  while (!enough(high)) {
    if (!failure || high == most) return std::nullopt;
    low = high, high = std::min(2 * high, most);
  }
  while (high - low > std::max(1u, high / 20)) {
    const std::uint32_t middle = low + (high - low) / 2;
    (enough(middle) ? high : low) = middle;
    if (!failure) return std::nullopt;
  }
  return high;
}

}  // namespace relume
