// SPDX-License-Identifier: MIT
#include "precompute/rooms.h"

#include <tbb/parallel_for.h>

#include <bit>

#include "core/mix.h"
#include "core/rooms.h"

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

void average_over_view(const std::vector<FormFactorRow>& rows, const std::vector<RoomFunctions>& values,
                       std::vector<RoomFunctions>& means) {
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t c) {
    RoomFunctions sum{};
    float weight = 0.0f;
    for (std::size_t i = 0; i < rows[c].senders.size() && rows[c].senders[i] < rows.size(); ++i) {
      weight += rows[c].values[i];
      for (std::size_t f = 0; f < kRoomFunctions; ++f)
        sum[f] += rows[c].values[i] * values[rows[c].senders[i]][f];
    }
    means[c] = values[c];
    if (weight <= 0.0f) return;
    for (std::size_t f = 0; f < kRoomFunctions; ++f) means[c][f] = sum[f] / weight;
  });
}

}  // namespace

std::vector<std::uint32_t> find_rooms(const std::vector<FormFactorRow>& rows,
                                      const std::vector<glm::vec3>& centroids,
                                      const std::vector<float>& areas) {
  RoomSearch search{areas, connected_sets(rows), {}};
  for (std::size_t c = 0; c < rows.size(); ++c) search.keys.push_back(key_of(rows[c], centroids[c]));
  const auto average = [&rows](const auto& values, auto& means) { average_over_view(rows, values, means); };
  return find_rooms(search, average).of_cluster;
}

}  // namespace relume
