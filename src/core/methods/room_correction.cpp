// SPDX-License-Identifier: MIT
#include "core/methods/room_correction.h"

#include <utility>

#include "core/methods/bounce_problem.h"

namespace relume {
namespace {

/// What each sender's radiosity adds to the clusters of one room, per leaf in the end.
void add_row(const CsrMatrix& matrix, std::uint32_t row, double factor, std::vector<double>& sums) {
  for (std::uint64_t entry = matrix.row_offsets[row]; entry < matrix.row_offsets[row + 1]; ++entry)
    sums[matrix.column_indices[entry]] += factor * matrix.values[entry];
}

std::vector<double> weights_of_room(const SenderMatrix& matrix, const std::vector<double>& areas,
                                    const std::vector<std::uint32_t>& clusters) {
  std::vector<double> sums(matrix.rows.columns, 0.0);
  for (const std::uint32_t cluster : clusters) add_row(matrix.rows, cluster, areas[cluster], sums);
  const std::uint32_t leaves = matrix.rows.columns - matrix.nodes.rows;
  for (std::uint32_t node = 0; node < matrix.nodes.rows; ++node) {
    if (sums[leaves + node] > 0.0) add_row(matrix.nodes, node, sums[leaves + node], sums);
  }
  sums.resize(areas.size());
  return sums;
}

/// 1 - C
std::vector<Rgb> balance_of_rooms(const RoomWeights& weights, const std::vector<Rgb>& albedo) {
  const std::size_t count = weights.rooms.count;
  std::vector<Rgb> matrix(count * count, Rgb(0.0));
  for (std::size_t room = 0; room < count; ++room) matrix[room * count + room] = Rgb(1.0);
  for (std::size_t j = 0; j < albedo.size(); ++j) {
    const std::uint32_t from = weights.rooms.of_cluster[j];
    if (from == kNone) continue;
    for (std::uint64_t k = weights.offsets[j]; k < weights.offsets[j + 1]; ++k) {
      const std::uint32_t to = weights.rooms_reached[k];
      matrix[to * count + from] -= weights.weights[k] / weights.areas[to] * albedo[j];
    }
  }
  return matrix;
}

}  // namespace

RoomWeights room_weights(const SenderMatrix& bounce_matrix, const std::vector<double>& areas,
                         const Rooms& rooms) {
  RoomWeights result{rooms, std::vector<double>(rooms.count, 0.0), {0}, {}, {}};
  std::vector<std::vector<std::uint32_t>> clusters(rooms.count);
  for (std::uint32_t i = 0; i < areas.size(); ++i) {
    if (rooms.of_cluster[i] == kNone) continue;
    clusters[rooms.of_cluster[i]].push_back(i);
    result.areas[rooms.of_cluster[i]] += areas[i];
  }
  std::vector<std::vector<std::pair<std::uint32_t, double>>> reached(areas.size());
  for (std::uint32_t room = 0; room < rooms.count; ++room) {
    const std::vector<double> weights = weights_of_room(bounce_matrix, areas, clusters[room]);
    for (std::size_t j = 0; j < areas.size(); ++j) {
      if (weights[j] > 0.0) reached[j].emplace_back(room, weights[j]);
    }
  }
  for (const auto& of_cluster : reached) {
    for (const auto& [room, weight] : of_cluster) {
      result.rooms_reached.push_back(room);
      result.weights.push_back(weight);
    }
    result.offsets.push_back(result.weights.size());
  }
  return result;
}

RoomSolver::RoomSolver(const RoomWeights& weights, const std::vector<Rgb>& albedo)
    : weights_(weights), balance_(balance_of_rooms(weights, albedo), weights.rooms.count) {}

std::vector<Rgb> RoomSolver::irradiance(const std::vector<Rgb>& change) const {
  std::vector<Rgb> c(weights_.rooms.count, Rgb(0.0));
  for (std::size_t j = 0; j < change.size(); ++j) {
    for (std::uint64_t k = weights_.offsets[j]; k < weights_.offsets[j + 1]; ++k)
      c[weights_.rooms_reached[k]] += weights_.weights[k] * change[j];
  }
  for (std::size_t room = 0; room < c.size(); ++room) c[room] /= weights_.areas[room];
  balance_.solve(c);
  return c;
}

void add_correction(const Rooms& rooms, const std::vector<Rgb>& albedo, const std::vector<Rgb>& irradiance,
                    std::vector<Rgb>& x) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (rooms.of_cluster[i] != kNone) x[i] += albedo[i] * irradiance[rooms.of_cluster[i]];
  }
}

Rooms correction_rooms(const Model& model, const SenderMatrix& bounce_matrix) {
  return largest_rooms(find_rooms(model, bounce_matrix, kCorrectionScale), cluster_areas(model),
                       kMaxCorrectionRooms);
}

}  // namespace relume
