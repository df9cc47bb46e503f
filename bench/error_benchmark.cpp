// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "benchmarks.h"
#include "measure/converged_answer.h"
#include "measure/room_errors.h"
#include "measure/test_lights.h"

namespace relume::bench {
namespace {

constexpr std::size_t kSensors = 2000;

struct Subject {
  std::string name;
  double error = 0.0;
  std::uint32_t budget = 0;
};

std::vector<Subject> subjects(const BenchmarkOptions& options) {
  const auto target = [](double error) {
    return Subject{fmt::format("--error {:.3g}%", 100.0 * error), error, 0};
  };
  if (options.error_given) return {target(options.error)};
  std::vector<Subject> all{target(0.05), target(0.02), target(0.01)};
  for (const std::uint32_t budget : {32u, 64u, 128u, 256u})
    all.push_back({fmt::format("--budget {}", budget), 0.0, budget});
  return all;
}

std::vector<double> worst_errors(const RoomTruth& truth, const SensorValues& values,
                                 double dark = kDarkRoom) {
  std::vector<double> errors;
  for (std::size_t l = 0; l < values.size(); ++l)
    errors.push_back(worst_room_error(truth, l, values[l], dark));
  return errors;
}

std::vector<double> worst_noise(const RoomTruth& truth) {
  std::vector<double> noise;
  for (std::size_t l = 0; l < truth.paths.values.size(); ++l) noise.push_back(worst_room_noise(truth, l));
  return noise;
}

void report_subject(const RoomTruth& truth, const Subject& subject, const SolvedModel& solved,
                    std::vector<Measurement>& result) {
  std::uint64_t factors = 0, bytes = 0, columns = 0, receivers = 0;
  for (const System& system : solved.model.systems) {
    for (const BlockMatrix* matrix : {&system.bounce, &system.gather}) {
      const MatrixSummary summary = summarise(*matrix);
      factors += summary.nonzeros, bytes += summary.bytes, receivers += summary.rows;
    }
    columns += system.imports.size();
  }
  const auto add = [&](const char* what, const char* unit, std::vector<double> values) {
    result.push_back({fmt::format("{}: {}", subject.name, what), unit, std::move(values)});
  };
  add("measured, five lights", "", worst_errors(truth, solved.values));
  add("  in rooms with a hundredth of the light", "", worst_errors(truth, solved.values, 0.01));
  if (subject.error > 0.0) {
    add("estimated", "", {solved.report.error.total()});
    add("  clusters, rays, cut", "",
        {solved.report.error.clusters, solved.report.error.rays, solved.report.error.cut});
  }
  add("form factors", "", {double(factors)});
  add("receivers", "", {double(receivers)});
  add("columns", "", {double(columns)});
  add("matrices", "bytes", {double(bytes)});
  add("rays", "", {double(solved.report.rays)});
  add("precompute", "s", {solved.report.seconds_total});
}

/// More and more paths for the sensors of noisy rooms, until noise is small or they are many.
Result<RoomTruth> trace_truth(const TestScene& test, const Model& dense) {
  constexpr double kSmallNoise = 0.05;
  constexpr std::uint32_t kMostPaths = 1u << 16;
  PathOptions options;
  options.sky = !dense.sky_cells.empty(), options.max_albedo = dense.max_albedo;
  auto paths = path_irradiance(test, options);
  if (!paths) return tl::unexpected(paths.error());
  RoomTruth truth{std::move(*paths), sensor_rooms(dense)};
  while (options.paths < kMostPaths) {
    options.sensors = noisy_sensors(truth, kSmallNoise);
    if (options.sensors.empty()) break;
    options.paths *= 4;
    fmt::print(stderr, "{} paths for {} sensors\n", options.paths, options.sensors.size());
    const auto more = path_irradiance(test, options);
    if (!more) return tl::unexpected(more.error());
    for (std::size_t l = 0; l < more->values.size(); ++l) {
      for (const std::uint32_t i : options.sensors) {
        truth.paths.values[l][i] = more->values[l][i];
        truth.paths.noise[l][i] = more->noise[l][i];
      }
    }
  }
  return truth;
}

}  // namespace

Measurements error(const BenchmarkOptions& options) {
  auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  PrecomputeOptions base;
  const auto test = test_scene(std::move(*scene), kSensors);
  if (!test) return tl::unexpected(test.error());
  base.sensors = test->sensors;
  const auto dense = dense_model(*test, base);
  if (!dense) return tl::unexpected(dense.error());
  const auto truth = trace_truth(*test, dense->model);
  if (!truth) return tl::unexpected(truth.error());
  std::vector<Measurement> result{
      {"noise of the paths, five lights", "", worst_noise(*truth)},
      {"clusters of a dense model", "", {double(cluster_offsets(dense->model).back())}},
      {"dense model: measured, five lights", "", worst_errors(*truth, dense->values)}};
  fmt::print(stderr, "{}: {}\n", result[2].name, fmt::join(result[2].values, " "));
  for (const Subject& subject : subjects(options)) {
    PrecomputeOptions chosen = base;
    chosen.error = subject.error, chosen.budget = subject.budget;
    chosen.quality = subject.budget > 0 ? options.quality : 0;
    chosen.sensor_quality = chosen.quality;
    const auto solved = solve_model(*test, chosen);
    if (!solved) return tl::unexpected(solved.error());
    report_subject(*truth, subject, *solved, result);
    for (const Measurement& m : std::span(result).last(subject.error > 0.0 ? 10 : 8))
      fmt::print(stderr, "{}: {}\n", m.name, fmt::join(m.values, " "));
  }
  return result;
}

}  // namespace relume::bench
