// SPDX-License-Identifier: MIT
#include "core/rooms.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/mix.h"

namespace relume {
namespace {

/// So many times kRoomFunctions: estimates of correlations are off by (1 - their square) / 8.
constexpr std::size_t kDraws = 2;
using Origin = std::array<float, kDraws * kRoomFunctions>;

/// Random signs of unit density: their sum over any surface has its area for variance. What is left of them
/// at a cluster after so many sweeps is a random projection of where light that ends there came from.
std::vector<RoomFunctions> random_signs(const RoomSearch& search, std::size_t draw) {
  std::vector<RoomFunctions> values(search.areas.size());
  for (std::size_t c = 0; c < values.size(); ++c) {
    const float strength = 1.0f / std::sqrt(search.areas[c]);
    const std::uint64_t bits = search.keys[c] >> draw * kRoomFunctions;
    for (std::size_t f = 0; f < kRoomFunctions; ++f) values[c][f] = bits >> f & 1u ? strength : -strength;
  }
  return values;
}

float product(const Origin& a, const Origin& b) {
  float sum = 0.0f;
  for (std::size_t f = 0; f < a.size(); ++f) sum += a[f] * b[f];
  return sum;
}

/// Where the light of each cluster came from, each of length 1, and the lengths that they had: the longer,
/// the smaller is what a cluster shares its light with.
struct Origins {
  std::vector<Origin> directions;
  std::vector<float> lengths;
};

float normalise(Origin& values) {
  const float length = std::sqrt(product(values, values));
  if (length <= 0.0f) return 0.0f;
  for (float& value : values) value /= length;
  return length;
}

Origins find_origins(const RoomSearch& search, const AverageOverView& average, int sweeps) {
  const std::size_t clusters = search.areas.size();
  Origins result{std::vector<Origin>(clusters), {}};
  std::vector<RoomFunctions> next(clusters);
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    std::vector<RoomFunctions> values = random_signs(search, draw);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      average(values, next);
      values.swap(next);
    }
    for (std::size_t c = 0; c < clusters; ++c)
      std::copy(values[c].begin(), values[c].end(), &result.directions[c][draw * kRoomFunctions]);
  }
  for (Origin& values : result.directions) result.lengths.push_back(normalise(values));
  return result;
}

/// Gives clusters that are like no room the mean of what they see, as the light of those that are comes to
/// them.
void adopt(const std::vector<bool>& like_a_room, const AverageOverView& average, Origins& origins) {
  constexpr int kSweeps = 8;
  const std::size_t clusters = like_a_room.size();
  std::vector<RoomFunctions> values(clusters), next(clusters);
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    for (std::size_t c = 0; c < clusters; ++c) {
      values[c] = {};
      const float* own = &origins.directions[c][draw * kRoomFunctions];
      if (like_a_room[c]) std::copy(own, own + kRoomFunctions, values[c].begin());
    }
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      average(values, next);
      for (std::size_t c = 0; c < clusters; ++c) {
        if (!like_a_room[c]) values[c] = next[c];
      }
    }
    for (std::size_t c = 0; c < clusters; ++c)
      std::copy(values[c].begin(), values[c].end(), &origins.directions[c][draw * kRoomFunctions]);
  }
  for (Origin& direction : origins.directions) normalise(direction);
}

/// What comes to a cluster from a room is part of its light, and spread as that is in the room: it cannot be
/// longer than what the leader has, but for chance. In pockets, which share with few, it is much longer where
/// it only seems to come from there.
constexpr double kMostFromRoom = 1.5;

struct Leader {
  std::uint32_t cluster = 0;
  double area = 0.0;  ///< of all that follow it
};

/// Clusters that differ from one another, per set, and the area of those that are like them. What keeps its
/// light best leads first: what lies in a door is like both rooms.
std::vector<std::vector<Leader>> find_leaders(const RoomSearch& search, const Origins& origins,
                                              double alike) {
  std::vector<std::uint32_t> order(search.areas.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return origins.lengths[a] > origins.lengths[b]; });
  std::vector<std::vector<Leader>> leaders(order.size());
  for (const std::uint32_t c : order) {
    auto& own = leaders[search.sets[c]];
    auto known = std::find_if(own.begin(), own.end(), [&](const Leader& l) {
      return double(product(origins.directions[c], origins.directions[l.cluster])) >= alike;
    });
    if (known == own.end()) known = own.insert(own.end(), {c, 0.0});
    known->area += double(search.areas[c]);
  }
  return leaders;
}

/// Those of no more than a share of their set go, unless all would.
void drop_small(std::vector<Leader>& leaders, double least_area) {
  const auto small = [least_area](const Leader& l) { return l.area < least_area; };
  if (!std::all_of(leaders.begin(), leaders.end(), small)) std::erase_if(leaders, small);
}

/// The leader that a cluster is most like, and how much.
std::pair<std::uint32_t, double> most_alike(const std::vector<Leader>& leaders, const Origins& origins,
                                            std::uint32_t cluster) {
  std::pair<std::uint32_t, double> best{kNone, -2.0};
  for (const Leader& leader : leaders) {
    const double alike = double(product(origins.directions[cluster], origins.directions[leader.cluster]));
    if (alike > best.second) best = {leader.cluster, alike};
  }
  return best;
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
  Origins origins = find_origins(search, average, scale.sweeps);
  std::vector<double> set_areas(clusters, 0.0);
  for (std::size_t c = 0; c < clusters; ++c) set_areas[search.sets[c]] += double(search.areas[c]);
  std::vector<std::vector<Leader>> leaders = find_leaders(search, origins, scale.alike);
  for (std::size_t set = 0; set < clusters; ++set)
    drop_small(leaders[set], scale.least_share * set_areas[set]);
  std::vector<std::uint32_t> leader(clusters);
  std::vector<bool> like_a_room(clusters);
  for (std::uint32_t c = 0; c < clusters; ++c) {
    const auto [most, alike] = most_alike(leaders[search.sets[c]], origins, c);
    leader[c] = most;
    like_a_room[c] = alike >= scale.barely_alike &&
                     alike * double(origins.lengths[c]) <= kMostFromRoom * double(origins.lengths[most]);
  }
  if (scale.adopts) adopt(like_a_room, average, origins);
  Rooms rooms{std::vector<std::uint32_t>(clusters, kNone), 0};
  std::vector<std::uint32_t> room_of_leader(clusters, kNone);
  for (std::uint32_t c = 0; c < clusters; ++c) {
    if (!like_a_room[c] && !scale.adopts) continue;
    if (!like_a_room[c]) leader[c] = most_alike(leaders[search.sets[c]], origins, c).first;
    std::uint32_t& room = room_of_leader[leader[c]];
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
  RoomSearch search{areas, joined_sets(bounce_matrix), {}};
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
