// SPDX-License-Identifier: MIT
#include "measure/converged_answer.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "core/reference_solver.h"
#include "precompute/rooms.h"

namespace relume {
namespace {

std::vector<Rgb> at_sensors(const Model& model, const std::vector<Rgb>& rows) {
  std::vector<Rgb> values;
  for (const std::uint32_t row : sensor_rows(model)) values.push_back(rows[row]);
  return values;
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

/// Clusters are so many lumels large.
Result<SolvedModel> solve_dense(const TestScene& test, const PrecomputeOptions& options,
                                const AnswerSize& size, double cluster_lumels,
                                const ProgressObserver& observer) {
  PrecomputeOptions chosen = options;
  chosen.quality = size.quality, chosen.sensor_quality = size.sensor_quality;
  chosen.texel_size = std::sqrt(area_of(test.scene) / size.clusters);
  chosen.cluster_size = cluster_lumels * chosen.texel_size;
  TestScene bare = test;
  for (SceneNode& node : bare.scene.nodes) {
    if (!node.extras.receiver) node.extras.receiver = "clusters";
  }
  return solve_model(bare, chosen, observer);
}

}  // namespace

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

Result<SolvedModel> solve_model(const TestScene& test, const PrecomputeOptions& options,
                                const ProgressObserver& observer) {
  SolvedModel result;
  auto model = precompute(test.scene, options, result.report, observer);
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

Result<SolvedModel> dense_model(const TestScene& test, const PrecomputeOptions& options,
                                const AnswerSize& size, const ProgressObserver& observer) {
  return solve_dense(test, options, size, 1.0, observer);
}

Result<ConvergedAnswer> converged_answer(const TestScene& test, const PrecomputeOptions& options,
                                         const AnswerSize& size, const ProgressObserver& observer) {
  const auto coarse = solve_dense(test, options, size, 2.0, observer);
  if (!coarse) return tl::unexpected(coarse.error());
  const auto fine = dense_model(test, options, size, observer);
  if (!fine) return tl::unexpected(fine.error());
  ConvergedAnswer answer{fine->values, fine->values, sensor_rooms(fine->model), 0};
  answer.clusters = cluster_offsets(fine->model).back();
  for (std::size_t l = 0; l < answer.values.size(); ++l) {
    for (std::size_t i = 0; i < answer.values[l].size(); ++i)
      answer.values[l][i] = glm::max(Rgb(0.0), 2.0 * answer.values[l][i] - coarse->values[l][i]);
  }
  return answer;
}

double sensor_error(const std::vector<std::uint32_t>& rooms, const std::vector<Rgb>& values,
                    const std::vector<Rgb>& reference) {
  double difference = 0.0, total = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (rooms[i] == kNone) continue;
    const Rgb off = values[i] - reference[i];
    difference += glm::dot(off, off), total += glm::dot(reference[i], reference[i]);
  }
  return total > 0.0 ? std::sqrt(difference / total) : 0.0;
}

double area_of(const Scene& scene) {
  double area = 0.0;
  for (const auto& t : scene.triangles) {
    const auto& p = scene.vertices.positions;
    area += 0.5 * glm::length(glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
  }
  return area;
}

}  // namespace relume
