// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "benchmarks.h"
#include "core/reference_solver.h"
#include "precompute/rooms.h"
#include "test_lights.h"

namespace relume::bench {
namespace {

constexpr const char* kName = "error";
constexpr std::size_t kSensors = 2000;
/// Of the converged answer, about.
constexpr double kTruthClusters = 24000.0;
/// A room with fewer of the sensors has no mean worth the name.
constexpr double kLeastSensors = 0.02;
/// Rooms this much dimmer than the brightest count as dark.
constexpr double kDark = 1e-3;

/// Irradiance at the sensors, per light.
using SensorValues = std::vector<std::vector<Rgb>>;

struct Truth {
  SensorValues values;
  std::vector<std::uint32_t> rooms;  ///< per sensor; kNone: sees next to nothing
  std::uint32_t clusters = 0;
};

struct SolvedModel {
  Model model;
  PrecomputeReport report;
  SensorValues values;
};

/// The gather row of each sensor, in the order that they were given.
std::vector<std::uint32_t> sensor_rows(const Model& model) {
  const std::vector<std::uint32_t> first = gather_offsets(model);
  std::vector<std::uint32_t> rows(model.sensor_names.size());
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    for (std::size_t i = 0; i < system.sensors.size(); ++i)
      rows[system.sensors[i].name] = first[s] + std::uint32_t(system.lumels.size() + i);
  }
  return rows;
}

std::vector<Rgb> at_sensors(const Model& model, const std::vector<Rgb>& rows) {
  std::vector<Rgb> values;
  for (const std::uint32_t row : sensor_rows(model)) values.push_back(rows[row]);
  return values;
}

Result<SolvedModel> solve_model(const TestScene& test, const PrecomputeOptions& options) {
  SolvedModel result;
  auto model = precompute(test.scene, options, result.report);
  if (!model) return tl::unexpected(model.error());
  result.model = std::move(*model);
  const ReferenceMatrices matrices = reference_matrices(result.model);
  for (const TestLight& light : test.lights) {
    const auto lighting = test_lighting(result.model, light);
    if (!lighting) return tl::unexpected(lighting.error());
    const auto solution = solve_reference(matrices.bounce, *lighting, {200, 1e-4});
    if (!solution) return tl::unexpected(solution.error());
    result.values.push_back(
        at_sensors(result.model, gather(matrices.gather, *lighting, solution->radiosity)));
  }
  return result;
}

std::vector<FormFactorRow> as_rows(const CsrMatrix& matrix) {
  std::vector<FormFactorRow> rows(matrix.rows);
  for (std::uint32_t r = 0; r < matrix.rows; ++r) {
    for (auto e = matrix.row_offsets[r]; e < matrix.row_offsets[r + 1]; ++e) {
      rows[r].senders.push_back(matrix.column_indices[e]);
      rows[r].values.push_back(float(matrix.values[e]));
    }
  }
  return rows;
}

/// The room that each sensor sees most of. Those that see mostly the backs of surfaces have none.
std::vector<std::uint32_t> sensor_rooms(const Model& model) {
  const ReferenceMatrices matrices = reference_matrices(model);
  std::vector<glm::vec3> centroids;
  std::vector<float> areas;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters)
      centroids.push_back(cluster.centroid), areas.push_back(cluster.area);
  }
  const auto rooms = find_rooms(as_rows(matrices.bounce.rows), centroids, areas);
  const std::vector<FormFactorRow> rows = as_rows(matrices.gather.rows);
  std::vector<std::uint32_t> result;
  for (const std::uint32_t i : sensor_rows(model)) {
    std::map<std::uint32_t, double> shares;
    double sum = 0.0;
    for (std::size_t k = 0; k < rows[i].senders.size(); ++k) {
      sum += double(rows[i].values[k]);
      if (rows[i].senders[k] < rooms.size()) shares[rooms[rows[i].senders[k]]] += double(rows[i].values[k]);
    }
    const auto most = std::max_element(shares.begin(), shares.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    result.push_back(sum < 0.3 || most == shares.end() ? kNone : most->first);
  }
  return result;
}

/// Extrapolated over cluster size: twice the answer of small clusters less that of clusters of twice the
/// size.
Result<Truth> find_truth(const TestScene& test, const PrecomputeOptions& base) {
  PrecomputeOptions options = base;
  options.quality = 256, options.sensor_quality = 1u << 16;
  const double size = std::sqrt(area_of(test.scene) / kTruthClusters);
  TestScene bare = test;
  for (SceneNode& node : bare.scene.nodes) {
    if (!node.extras.receiver) node.extras.receiver = "clusters";
  }
  options.texel_size = size, options.cluster_size = 2.0 * size;
  const auto coarse = solve_model(bare, options);
  if (!coarse) return tl::unexpected(coarse.error());
  options.cluster_size = size;
  const auto fine = solve_model(bare, options);
  if (!fine) return tl::unexpected(fine.error());
  Truth truth{fine->values, sensor_rooms(fine->model), 0};
  for (const System& system : fine->model.systems) truth.clusters += std::uint32_t(system.clusters.size());
  for (std::size_t l = 0; l < truth.values.size(); ++l) {
    for (std::size_t i = 0; i < truth.values[l].size(); ++i)
      truth.values[l][i] = glm::max(Rgb(0.0), 2.0 * truth.values[l][i] - coarse->values[l][i]);
  }
  return truth;
}

struct RoomSums {
  double difference = 0.0, total = 0.0, count = 0.0;
};

/// The worst over rooms of |I - I*| / |I*|.
double worst_room(const Truth& truth, std::size_t light, const std::vector<Rgb>& values) {
  std::map<std::uint32_t, RoomSums> sums;
  double counted = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (truth.rooms[i] == kNone) continue;
    RoomSums& room = sums[truth.rooms[i]];
    const Rgb difference = values[i] - truth.values[light][i];
    room.difference += glm::dot(difference, difference);
    room.total += glm::dot(truth.values[light][i], truth.values[light][i]);
    room.count += 1.0, counted += 1.0;
  }
  double brightest = 0.0, worst = 0.0;
  for (const auto& [index, room] : sums) brightest = std::max(brightest, room.total / room.count);
  for (const auto& [index, room] : sums) {
    if (room.count < kLeastSensors * counted || room.total / room.count < kDark * kDark * brightest) continue;
    worst = std::max(worst, std::sqrt(room.difference / room.total));
  }
  return worst;
}

struct Subject {
  std::string name;
  double error = 0.0;
  std::uint32_t budget = 0;
};

std::vector<Subject> subjects() {
  std::vector<Subject> all;
  for (const int percent : {5, 2, 1}) all.push_back({fmt::format("--error {}%", percent), 0.01 * percent, 0});
  for (const std::uint32_t budget : {32u, 64u, 128u, 256u})
    all.push_back({fmt::format("--budget {}", budget), 0.0, budget});
  return all;
}

void report_subject(const Truth& truth, const Subject& subject, const SolvedModel& solved,
                    std::vector<Measurement>& result) {
  std::uint64_t factors = 0, bytes = 0, columns = 0, receivers = 0;
  for (const System& system : solved.model.systems) {
    for (const BlockMatrix* matrix : {&system.bounce, &system.gather}) {
      const MatrixSummary summary = summarise(*matrix);
      factors += summary.nonzeros, bytes += summary.bytes, receivers += summary.rows;
    }
    columns += system.imports.size();
  }
  std::vector<double> errors;
  for (std::size_t l = 0; l < solved.values.size(); ++l)
    errors.push_back(worst_room(truth, l, solved.values[l]));
  const auto add = [&](const char* what, const char* unit, std::vector<double> values) {
    result.push_back({kName, fmt::format("{}: {}", subject.name, what), unit, std::move(values)});
  };
  add("measured, five lights", "", errors);
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

}  // namespace

Measurements error(const BenchmarkOptions& options) {
  auto scene = benchmark_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  PrecomputeOptions base;
  const auto test = test_scene(std::move(*scene), kSensors);
  if (!test) return tl::unexpected(test.error());
  base.sensors = test->sensors;
  const auto truth = find_truth(*test, base);
  if (!truth) return tl::unexpected(truth.error());
  std::vector<Measurement> result{{kName, "clusters of the converged answer", "", {double(truth->clusters)}}};
  for (const Subject& subject : subjects()) {
    PrecomputeOptions chosen = base;
    chosen.error = subject.error, chosen.budget = subject.budget;
    chosen.quality = subject.budget > 0 ? options.quality : 0;
    chosen.sensor_quality = chosen.quality;
    const auto solved = solve_model(*test, chosen);
    if (!solved) return tl::unexpected(solved.error());
    report_subject(*truth, subject, *solved, result);
    for (const Measurement& m : std::span(result).last(subject.error > 0.0 ? 9 : 7))
      fmt::print(stderr, "{}: {}\n", m.name, fmt::join(m.values, " "));
  }
  return result;
}

}  // namespace relume::bench
