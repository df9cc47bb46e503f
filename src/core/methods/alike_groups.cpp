// SPDX-License-Identifier: MIT
#include "core/methods/alike_groups.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/mix.h"

namespace relume {
namespace {

constexpr int kGroupingSweeps = 6;
constexpr int kSteps = 5;  // of Lloyd

/// Random signs after some averages, scaled to mean squares of 1 by area.
std::vector<RoomFunctions> relaxed_signs(const SenderMatrix& matrix, const std::vector<double>& areas) {
  std::vector<RoomFunctions> values(areas.size()), next(areas.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint64_t bits = mix(0x47524f5550ull, i);
    for (std::size_t f = 0; f < kRoomFunctions; ++f) values[i][f] = bits >> f & 1u ? 1.0f : -1.0f;
  }
  for (int sweep = 0; sweep < kGroupingSweeps; ++sweep) {
    average_over_view(matrix, values, next);
    values.swap(next);
  }
  double area = 0.0;
  std::array<double, kRoomFunctions> squares{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    area += areas[i];
    for (std::size_t f = 0; f < kRoomFunctions; ++f) squares[f] += areas[i] * values[i][f] * values[i][f];
  }
  for (RoomFunctions& value : values) {
    for (std::size_t f = 0; f < kRoomFunctions; ++f)
      value[f] *= squares[f] > 0.0 ? static_cast<float>(std::sqrt(area / squares[f])) : 0.0f;
  }
  return values;
}

float squared_distance(const RoomFunctions& a, const RoomFunctions& b) {
  float sum = 0.0f;
  for (std::size_t f = 0; f < kRoomFunctions; ++f) sum += (a[f] - b[f]) * (a[f] - b[f]);
  return sum;
}

/// The clusters in the middle of equal shares of all area, in their order, which follows space.
std::vector<RoomFunctions> first_means(const std::vector<RoomFunctions>& values,
                                       const std::vector<double>& areas, std::uint32_t count) {
  double area = 0.0, passed = 0.0;
  for (const double a : areas) area += a;
  std::vector<RoomFunctions> means;
  for (std::size_t i = 0; i < values.size() && means.size() < count; ++i) {
    passed += areas[i];
    if (passed * count >= (double(means.size()) + 0.5) * area) means.push_back(values[i]);
  }
  return means;
}

std::uint32_t nearest(const std::vector<RoomFunctions>& means, const RoomFunctions& value) {
  std::uint32_t best = 0;
  float least = squared_distance(means[0], value);
  for (std::uint32_t g = 1; g < means.size(); ++g) {
    const float distance = squared_distance(means[g], value);
    if (distance < least) best = g, least = distance;
  }
  return best;
}

/// Of groups that have no cluster the mean stays.
void take_means(const std::vector<RoomFunctions>& values, const std::vector<double>& areas,
                const std::vector<std::uint32_t>& group, std::vector<RoomFunctions>& means) {
  std::vector<std::array<double, kRoomFunctions>> sums(means.size());
  std::vector<double> weights(means.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    weights[group[i]] += areas[i];
    for (std::size_t f = 0; f < kRoomFunctions; ++f) sums[group[i]][f] += areas[i] * values[i][f];
  }
  for (std::size_t g = 0; g < means.size(); ++g) {
    if (weights[g] <= 0.0) continue;
    for (std::size_t f = 0; f < kRoomFunctions; ++f)
      means[g][f] = static_cast<float>(sums[g][f] / weights[g]);
  }
}

/// Leaves each group the clusters of one set: that of which it has the most.
void keep_one_set(const std::vector<std::uint32_t>& sets, const std::vector<double>& areas,
                  std::vector<std::uint32_t>& group) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> shares;  // of group and set
  for (std::size_t i = 0; i < group.size(); ++i) shares[{group[i], sets[i]}] += areas[i];
  std::map<std::uint32_t, std::pair<double, std::uint32_t>> largest;  // of a group: area, set
  for (const auto& [key, area] : shares) {
    auto& best = largest[key.first];
    if (area > best.first) best = {area, key.second};
  }
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (largest[group[i]].second != sets[i]) group[i] = kNone;
  }
}

/// Numbers from 0 in the order of the first clusters.
Rooms renumbered(const std::vector<std::uint32_t>& group, std::size_t count) {
  std::vector<std::uint32_t> numbers(count, kNone);
  Rooms result{group, 0};
  for (std::uint32_t& g : result.of_cluster) {
    if (g == kNone) continue;
    if (numbers[g] == kNone) numbers[g] = result.count++;
    g = numbers[g];
  }
  return result;
}

}  // namespace

Rooms alike_groups(const SenderMatrix& bounce_matrix, const std::vector<double>& areas, std::uint32_t most) {
  if (areas.empty() || most == 0) return {std::vector<std::uint32_t>(areas.size(), kNone), 0};
  const std::vector<RoomFunctions> values = relaxed_signs(bounce_matrix, areas);
  std::vector<RoomFunctions> means = first_means(values, areas, most);
  std::vector<std::uint32_t> group(areas.size());
  for (int step = 0; step < kSteps; ++step) {
    if (step > 0) take_means(values, areas, group, means);
    for (std::size_t i = 0; i < values.size(); ++i) group[i] = nearest(means, values[i]);
  }
  keep_one_set(joined_sets(bounce_matrix), areas, group);
  return renumbered(group, means.size());
}

}  // namespace relume
