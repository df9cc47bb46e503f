// SPDX-License-Identifier: MIT
#include "core/rooms.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "core/mix.h"

namespace relume {
namespace {

constexpr std::size_t kWaves = 16, kSigns = 16;
static_assert(kWaves + kSigns == kRoomFunctions);
/// Of random signs beside waves between -1 and 1.
constexpr double kSignStrength = 0.3;
/// The first functions: waves across the scene, from as long as it is to a sixteenth. They tell far from
/// near.
void add_waves(const std::vector<glm::vec3>& centroids, std::vector<RoomFunctions>& values) {
  glm::vec3 lower = centroids[0], upper = lower;
  for (const glm::vec3& c : centroids) lower = glm::min(lower, c), upper = glm::max(upper, c);
  const glm::vec3 size = upper - lower;
  const float extent = std::max({size.x, size.y, size.z, 1e-6f});
  for (std::size_t f = 0; f < kWaves; ++f) {
    const auto random = [&](std::uint64_t k) {
      return double(mix(0x524f4f4dull + f, k) >> 40) / double(1 << 24);
    };
    glm::dvec3 wave(random(0) - 0.5, 0.5 * (random(1) - 0.5), random(2) - 0.5);
    const double waves_across = std::pow(16.0, double(f) / (kWaves - 1));
    wave *= waves_across / (std::max(glm::length(wave), 1e-3) * double(extent));
    for (std::size_t c = 0; c < centroids.size(); ++c) {
      const double phase = glm::dot(wave, glm::dvec3(centroids[c] - lower)) + random(3);
      // A triangle wave: the same on every machine.
      values[c][f] = float(4.0 * std::abs(phase - std::floor(phase) - 0.5) - 1.0);
    }
  }
}

/// The other functions: random signs, as strong as makes their means over rooms differ by kSignStrength or
/// more (the mean of n signs is about 1 / sqrt(n)). They tell apart what lies in one place: a cavity around a
/// room has the means of the room in every wave.
void add_signs(const RoomSearch& search, std::vector<RoomFunctions>& values) {
  const std::size_t count = values.size();
  std::vector<double> sums(count, 0.0), squares(count, 0.0);
  for (std::size_t c = 0; c < count; ++c) {
    sums[search.sets[c]] += double(search.areas[c]);
    squares[search.sets[c]] += double(search.areas[c]) * double(search.areas[c]);
  }
  for (std::size_t c = 0; c < count; ++c) {
    const std::uint32_t set = search.sets[c];
    const auto strength = float(kSignStrength * sums[set] / std::sqrt(squares[set]));
    for (std::size_t f = 0; f < kSigns; ++f)
      values[c][kWaves + f] = search.keys[c] >> f & 1u ? strength : -strength;
  }
}

double difference(const RoomFunctions& a, const RoomFunctions& b) {
  double sum = 0.0;
  for (std::size_t f = 0; f < kRoomFunctions; ++f) sum += double(a[f] - b[f]) * double(a[f] - b[f]);
  return std::sqrt(sum / kRoomFunctions);
}

struct Leader {
  std::uint32_t cluster = 0;
  double area = 0.0;  ///< of all that follow it
};

/// The leader whose functions are nearest among those of so much area; `leaders.size()` when there is none.
std::size_t nearest(const std::vector<Leader>& leaders, const std::vector<RoomFunctions>& values,
                    std::uint32_t cluster, double least_area) {
  std::size_t best = leaders.size();
  double distance = 0.0;
  for (std::size_t l = 0; l < leaders.size(); ++l) {
    if (leaders[l].area < least_area) continue;
    const double d = difference(values[cluster], values[leaders[l].cluster]);
    if (best == leaders.size() || d < distance) best = l, distance = d;
  }
  return best;
}

std::vector<RoomFunctions> relaxed_functions(const RoomSearch& search, const AverageOverView& average,
                                             int sweeps) {
  std::vector<RoomFunctions> values(search.areas.size());
  add_waves(search.centroids, values);
  add_signs(search, values);
  std::vector<RoomFunctions> next(values.size());
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    average(values, next);
    values.swap(next);
  }
  return values;
}

/// Of each set: clusters that differ from one another, and the area of those that are like them.
std::vector<std::vector<Leader>> find_leaders(const RoomSearch& search,
                                              const std::vector<RoomFunctions>& values, double same) {
  std::vector<std::vector<Leader>> leaders(values.size());
  for (std::uint32_t c = 0; c < values.size(); ++c) {
    auto& own = leaders[search.sets[c]];
    auto known = std::find_if(own.begin(), own.end(), [&](const Leader& l) {
      return difference(values[c], values[l.cluster]) < same;
    });
    if (known == own.end()) known = own.insert(own.end(), {c, 0.0});
    known->area += search.areas[c];
  }
  return leaders;
}

/// Differs between the two sides of a sheet too, which have one centroid.
std::uint64_t key_of(double first_value, const glm::vec3& centroid) {
  std::uint64_t key = std::bit_cast<std::uint32_t>(static_cast<float>(first_value));
  for (int k = 0; k < 3; ++k) key = mix(key, std::bit_cast<std::uint32_t>(centroid[k]));
  return mix(key, 0x524f4f4dull);
}

/// Functions of all senders: zero for the sky, with which the share of a sender that is no sky comes last.
struct WeightedFunctions {
  RoomFunctions values{};
  float weight = 0.0f;
};

WeightedFunctions weighted_sum(const CsrMatrix& matrix, std::uint32_t row,
                               const std::vector<WeightedFunctions>& senders) {
  WeightedFunctions sum;
  for (std::uint64_t entry = matrix.row_offsets[row]; entry < matrix.row_offsets[row + 1]; ++entry) {
    const WeightedFunctions& sender = senders[matrix.column_indices[entry]];
    const auto value = static_cast<float>(matrix.values[entry]);
    sum.weight += value * sender.weight;
    for (std::size_t f = 0; f < kRoomFunctions; ++f) sum.values[f] += value * sender.values[f];
  }
  return sum;
}

}  // namespace

void average_over_view(const SenderMatrix& matrix, const std::vector<RoomFunctions>& values,
                       std::vector<RoomFunctions>& means) {
  std::vector<WeightedFunctions> senders;
  senders.reserve(matrix.rows.columns);
  for (const RoomFunctions& cluster : values) senders.push_back({cluster, 1.0f});
  senders.resize(matrix.rows.columns - matrix.nodes.rows);
  for (std::uint32_t node = 0; node < matrix.nodes.rows; ++node)
    senders.push_back(weighted_sum(matrix.nodes, node, senders));
  for (std::uint32_t row = 0; row < values.size(); ++row) {
    const WeightedFunctions sum = weighted_sum(matrix.rows, row, senders);
    means[row] = values[row];
    if (sum.weight <= 0.0f) continue;
    for (std::size_t f = 0; f < kRoomFunctions; ++f) means[row][f] = sum.values[f] / sum.weight;
  }
}

JoinedSets::JoinedSets(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
}

std::uint32_t JoinedSets::find(std::uint32_t i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

void JoinedSets::join(std::uint32_t a, std::uint32_t b) {
  a = find(a), b = find(b);
  if (a != b) parent_[std::max(a, b)] = std::min(a, b);
}

std::vector<std::uint32_t> JoinedSets::all() {
  std::vector<std::uint32_t> result(parent_.size());
  for (std::uint32_t i = 0; i < result.size(); ++i) result[i] = find(i);
  return result;
}

std::vector<std::uint32_t> joined_sets(const SenderMatrix& matrix) {
  const std::uint32_t clusters = matrix.rows.rows;
  const std::uint32_t leaves = matrix.rows.columns - matrix.nodes.rows;
  JoinedSets sets(clusters);
  for (std::uint32_t row = 0; row < clusters; ++row) {
    for (std::uint64_t entry = matrix.rows.row_offsets[row]; entry < matrix.rows.row_offsets[row + 1];
         ++entry) {
      const std::uint32_t sender = matrix.rows.column_indices[entry];
      if (sender < clusters) sets.join(row, sender);
      if (sender < leaves) continue;
      const std::uint32_t node = sender - leaves;
      for (std::uint64_t leaf = matrix.nodes.row_offsets[node]; leaf < matrix.nodes.row_offsets[node + 1];
           ++leaf) {
        if (matrix.nodes.column_indices[leaf] < clusters) sets.join(row, matrix.nodes.column_indices[leaf]);
      }
    }
  }
  return sets.all();
}

Rooms find_rooms(const RoomSearch& search, const AverageOverView& average, const RoomScale& scale) {
  const std::size_t clusters = search.areas.size();
  if (clusters == 0) return {};
  const std::vector<RoomFunctions> values = relaxed_functions(search, average, scale.sweeps);
  std::vector<double> set_areas(clusters, 0.0);
  for (std::size_t c = 0; c < clusters; ++c) set_areas[search.sets[c]] += double(search.areas[c]);
  const std::vector<std::vector<Leader>> leaders = find_leaders(search, values, scale.same_room);
  std::vector<std::uint32_t> room_of_leader(clusters, kNone);
  Rooms rooms{std::vector<std::uint32_t>(clusters), 0};
  for (std::uint32_t c = 0; c < clusters; ++c) {
    const auto& own = leaders[search.sets[c]];
    std::size_t leader = nearest(own, values, c, scale.least_share * set_areas[search.sets[c]]);
    if (leader == own.size()) leader = nearest(own, values, c, 0.0);
    if (difference(values[c], values[own[leader].cluster]) > scale.largest_difference) {
      rooms.of_cluster[c] = kNone;
      continue;
    }
    std::uint32_t& room = room_of_leader[own[leader].cluster];
    if (room == kNone) room = rooms.count++;
    rooms.of_cluster[c] = room;
  }
  return rooms;
}

Rooms largest_rooms(const Rooms& rooms, const std::vector<double>& areas, std::uint32_t most) {
  std::vector<double> room_areas(rooms.count, 0.0);
  for (std::size_t c = 0; c < areas.size(); ++c) {
    if (rooms.of_cluster[c] != kNone) room_areas[rooms.of_cluster[c]] += areas[c];
  }
  std::vector<std::uint32_t> order(rooms.count);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return room_areas[a] > room_areas[b]; });
  order.resize(std::min(most, rooms.count));
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> numbers(rooms.count, kNone);
  for (std::uint32_t k = 0; k < order.size(); ++k) numbers[order[k]] = k;
  Rooms result{rooms.of_cluster, static_cast<std::uint32_t>(order.size())};
  for (std::uint32_t& room : result.of_cluster) room = room == kNone ? kNone : numbers[room];
  return result;
}

Rooms find_rooms(const SenderMatrix& bounce_matrix, const std::vector<glm::vec3>& centroids,
                 const std::vector<float>& areas, const RoomScale& scale) {
  RoomSearch search{centroids, areas, joined_sets(bounce_matrix), {}};
  const CsrMatrix& rows = bounce_matrix.rows;
  for (std::uint32_t row = 0; row < rows.rows; ++row) {
    const std::uint64_t first = rows.row_offsets[row];
    search.keys.push_back(
        key_of(first < rows.row_offsets[row + 1] ? rows.values[first] : 0.0, centroids[row]));
  }
  const auto average = [&bounce_matrix](const auto& values, auto& means) {
    average_over_view(bounce_matrix, values, means);
  };
  return find_rooms(search, average, scale);
}

Rooms find_rooms(const Model& model, const SenderMatrix& bounce_matrix, const RoomScale& scale) {
  std::vector<glm::vec3> centroids;
  std::vector<float> areas;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) {
      centroids.push_back(cluster.centroid);
      areas.push_back(cluster.area);
    }
  }
  return find_rooms(bounce_matrix, centroids, areas, scale);
}

}  // namespace relume
