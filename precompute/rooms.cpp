// SPDX-License-Identifier: MIT
#include "precompute/rooms.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>

#include "core/mix.h"
#include "core/rooms.h"
#include "precompute/weighted_sums.h"

namespace relume {
namespace {

std::vector<std::uint32_t> connected_sets(const std::vector<FormFactorRow>& rows) {
  JoinedSets sets(rows.size());
  for (std::uint32_t c = 0; c < rows.size(); ++c) {
    for (const auto sender : rows[c].senders) {
      if (sender < rows.size()) sets.join(c, sender);
    }
  }
  return sets.all();
}

/// Differs between the two sides of a sheet too, which have one centroid.
std::uint64_t key_of(const FormFactorRow& row, const glm::vec3& centroid) {
  std::uint64_t key = row.values.empty() ? 0 : std::bit_cast<std::uint32_t>(row.values[0]);
  for (int k = 0; k < 3; ++k) key = mix(key, std::bit_cast<std::uint32_t>(centroid[k]));
  return mix(key, 0x524f4f4dull);
}

/// The clusters that one sees.
struct SeenClusters {
  std::span<const std::uint32_t> senders;
  std::span<const float> factors;
  float weight = 0.0f;  ///< sum of factors
};

std::vector<SeenClusters> seen_clusters(const std::vector<FormFactorRow>& rows) {
  std::vector<SeenClusters> seen;
  for (const FormFactorRow& row : rows) {
    // Senders ascend, those of the sky last.
    const auto sky = std::lower_bound(row.senders.begin(), row.senders.end(), std::uint32_t(rows.size()));
    const std::span senders(row.senders.begin(), sky);
    const auto factors = std::span(row.values).first(senders.size());
    seen.push_back({senders, factors, std::accumulate(factors.begin(), factors.end(), 0.0f)});
  }
  return seen;
}

void average_over_view(const std::vector<SeenClusters>& seen, const std::vector<RoomFunctions>& values,
                       std::vector<RoomFunctions>& means) {
  tbb::parallel_for(std::size_t{0}, seen.size(), [&](std::size_t c) {
    means[c] = values[c];
    if (seen[c].weight <= 0.0f) return;
    RoomFunctions sum{};
    add_weighted(seen[c].senders, seen[c].factors, values, sum);
    for (std::size_t f = 0; f < kRoomFunctions; ++f) means[c][f] = sum[f] / seen[c].weight;
  });
}

}  // namespace

std::vector<std::uint32_t> find_rooms(const std::vector<FormFactorRow>& rows,
                                      const std::vector<glm::vec3>& centroids,
                                      const std::vector<float>& areas) {
  RoomSearch search{areas, connected_sets(rows), {}};
  for (std::size_t c = 0; c < rows.size(); ++c) search.keys.push_back(key_of(rows[c], centroids[c]));
  const auto seen = seen_clusters(rows);
  const auto average = [&seen](const auto& values, auto& means) { average_over_view(seen, values, means); };
  return find_rooms(search, average).of_cluster;
}

}  // namespace relume
