// SPDX-License-Identifier: MIT
#include "precompute/rooms.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <numeric>

#include "precompute/sampling.h"

namespace relume {
namespace {

constexpr std::size_t kWaves = 16, kSigns = 16, kFunctions = kWaves + kSigns;
/// Of random signs beside waves between -1 and 1.
constexpr double kSignStrength = 0.3;
/// Inside a room differences shrink to about 0.6 at each sweep, across a door to 0.96.
constexpr int kSweeps = 16;
/// Root mean square difference to the first cluster of a room. Of 0.12 to 0.5, this one gave furnished scenes
/// the least error at a given budget.
constexpr double kSameRoom = 0.3;
/// A room of less than this share of what it is joined to is part of one of its neighbours.
constexpr double kLeastShare = 0.02;

using Functions = std::array<float, kFunctions>;

/// Sets of clusters that are joined one pair after the other; the smaller number stands for the set.
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::vector<std::uint32_t> connected_sets(const std::vector<FormFactorRow>& rows) {
  JoinedSets sets(rows.size());
  for (std::uint32_t c = 0; c < rows.size(); ++c) {
    for (const auto sender : rows[c].senders) {
      if (sender < rows.size()) sets.join(c, sender);
    }
  }
  std::vector<std::uint32_t> result(rows.size());
  for (std::uint32_t c = 0; c < rows.size(); ++c) result[c] = sets.find(c);
  return result;
}

/// The first functions: waves across the scene, from as long as it is to a sixteenth. They tell far from
/// near.
void add_waves(const std::vector<glm::vec3>& centroids, std::vector<Functions>& values) {
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

/// Differs between the two sides of a sheet too, which have one centroid.
std::uint64_t key_of(const FormFactorRow& row, const glm::vec3& centroid) {
  std::uint64_t key = row.values.empty() ? 0 : std::bit_cast<std::uint32_t>(row.values[0]);
  for (int k = 0; k < 3; ++k) key = mix(key, std::bit_cast<std::uint32_t>(centroid[k]));
  return mix(key, 0x524f4f4dull);
}

/// The other functions: random signs, as strong as makes their means over rooms differ by kSignStrength or
/// more (the mean of n signs is about 1 / sqrt(n)). They tell apart what lies in one place: a cavity around a
/// room has the means of the room in every wave.
void add_signs(const std::vector<FormFactorRow>& rows, const std::vector<std::uint32_t>& sets,
               const std::vector<glm::vec3>& centroids, const std::vector<float>& areas,
               std::vector<Functions>& values) {
  std::vector<double> sums(rows.size(), 0.0), squares(rows.size(), 0.0);
  for (std::size_t c = 0; c < rows.size(); ++c) {
    sums[sets[c]] += double(areas[c]);
    squares[sets[c]] += double(areas[c]) * double(areas[c]);
  }
  for (std::size_t c = 0; c < rows.size(); ++c) {
    const auto strength = float(kSignStrength * sums[sets[c]] / std::sqrt(squares[sets[c]]));
    const std::uint64_t bits = key_of(rows[c], centroids[c]);
    for (std::size_t f = 0; f < kSigns; ++f) values[c][kWaves + f] = bits >> f & 1u ? strength : -strength;
  }
}

void relax(const std::vector<FormFactorRow>& rows, std::vector<Functions>& values) {
  std::vector<Functions> next(values.size());
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t c) {
      Functions sum{};
      float weight = 0.0f;
      for (std::size_t i = 0; i < rows[c].senders.size() && rows[c].senders[i] < rows.size(); ++i) {
        weight += rows[c].values[i];
        for (std::size_t f = 0; f < kFunctions; ++f)
          sum[f] += rows[c].values[i] * values[rows[c].senders[i]][f];
      }
      next[c] = values[c];
      if (weight <= 0.0f) return;
      for (std::size_t f = 0; f < kFunctions; ++f) next[c][f] = sum[f] / weight;
    });
    values.swap(next);
  }
}

double difference(const Functions& a, const Functions& b) {
  double sum = 0.0;
  for (std::size_t f = 0; f < kFunctions; ++f) sum += double(a[f] - b[f]) * double(a[f] - b[f]);
  return std::sqrt(sum / kFunctions);
}

struct Leader {
  std::uint32_t cluster = 0;
  double area = 0.0;  ///< of all that follow it
};

/// The leader whose functions are nearest among those of so much area; `leaders.size()` when there is none.
std::size_t nearest(const std::vector<Leader>& leaders, const std::vector<Functions>& values,
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

}  // namespace

std::vector<std::uint32_t> find_rooms(const std::vector<FormFactorRow>& rows,
                                      const std::vector<glm::vec3>& centroids,
                                      const std::vector<float>& areas) {
  if (rows.empty()) return {};
  const std::vector<std::uint32_t> sets = connected_sets(rows);
  std::vector<Functions> values(rows.size());
  add_waves(centroids, values);
  add_signs(rows, sets, centroids, areas, values);
  relax(rows, values);
  std::vector<double> set_areas(rows.size(), 0.0);
  for (std::size_t c = 0; c < rows.size(); ++c) set_areas[sets[c]] += areas[c];
  std::vector<std::vector<Leader>> leaders(rows.size());  // of each set
  for (std::uint32_t c = 0; c < rows.size(); ++c) {
    auto& own = leaders[sets[c]];
    auto known = std::find_if(own.begin(), own.end(), [&](const Leader& l) {
      return difference(values[c], values[l.cluster]) < kSameRoom;
    });
    if (known == own.end()) known = own.insert(own.end(), {c, 0.0});
    known->area += areas[c];
  }
  std::vector<std::uint32_t> room_of_leader(rows.size(), kNone), rooms(rows.size());
  std::uint32_t count = 0;
  for (std::uint32_t c = 0; c < rows.size(); ++c) {
    const auto& own = leaders[sets[c]];
    std::size_t leader = nearest(own, values, c, kLeastShare * set_areas[sets[c]]);
    if (leader == own.size()) leader = nearest(own, values, c, 0.0);
    std::uint32_t& room = room_of_leader[own[leader].cluster];
    if (room == kNone) room = count++;
    rooms[c] = room;
  }
  return rooms;
}

}  // namespace relume
