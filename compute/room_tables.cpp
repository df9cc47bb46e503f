// SPDX-License-Identifier: MIT
#include "compute/room_tables.h"

#include <algorithm>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "compute/pass_buffers.h"
#include "kernels/shared/bindings.h"

namespace relume {
namespace {

static_assert(kRoomSegments == kernels::kRoomSegmentsBinding &&
              kRoomEntries == kernels::kRoomEntriesBinding &&
              kRoomOfCluster == kernels::kRoomOfClusterBinding && kRoomSums == kernels::kRoomSumsBinding &&
              kRoomBuffers == kernels::kRoomBindings);
static_assert(sizeof(RoomEntry) == 8);

Result<void> check(const Model& model, const RoomWeights& weights) {
  if (weights.rooms.count > kMaxDeviceRooms) {
    return fail(ErrorCode::usage, "a device corrects at most " + std::to_string(kMaxDeviceRooms) +
                                      " rooms, found " + std::to_string(weights.rooms.count));
  }
  const std::uint32_t clusters = cluster_offsets(model).back();
  if (weights.rooms.of_cluster.size() != clusters || weights.offsets.size() != std::size_t{clusters} + 1) {
    return fail(ErrorCode::usage, "the rooms are of " + std::to_string(weights.rooms.of_cluster.size()) +
                                      " clusters, but the model has " + std::to_string(clusters));
  }
  return {};
}

std::size_t sum_count(const RoomTables& tables) {
  const std::size_t systems = tables.first_cluster.size() - 1;
  return kernels::kMaxRooms + 2 * systems * kernels::kRoomPairs;
}

/// What of a room's weights is left out: those below this share of their mean, so that no more than this
/// share of all is. The rest is scaled up to the whole.
constexpr double kLeastShare = 0.01;

struct RoomCut {
  std::vector<double> least;   ///< weight, per room
  std::vector<double> factor;  ///< per room, over its area
};

RoomCut cut_of(const RoomWeights& weights) {
  std::vector<double> sum(weights.rooms.count, 0.0), kept = sum;
  std::vector<std::size_t> count(weights.rooms.count, 0);
  for (std::size_t k = 0; k < weights.weights.size(); ++k) {
    sum[weights.rooms_reached[k]] += weights.weights[k];
    ++count[weights.rooms_reached[k]];
  }
  RoomCut cut{sum, sum};
  for (std::uint32_t room = 0; room < weights.rooms.count; ++room)
    cut.least[room] *= kLeastShare / double(std::max<std::size_t>(count[room], 1));
  for (std::size_t k = 0; k < weights.weights.size(); ++k) {
    const std::uint32_t room = weights.rooms_reached[k];
    if (weights.weights[k] >= cut.least[room]) kept[room] += weights.weights[k];
  }
  for (std::uint32_t room = 0; room < weights.rooms.count; ++room)
    cut.factor[room] = kept[room] > 0.0 ? sum[room] / (kept[room] * weights.areas[room]) : 0.0;
  return cut;
}

/// By room that sees them, and their own.
using Segments = std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<RoomEntry>>;

Segments segments_of(const RoomWeights& weights, const RoomCut& cut, std::uint32_t first, std::uint32_t end) {
  Segments segments;
  for (std::uint32_t j = first; j < end; ++j) {
    for (std::uint64_t k = weights.offsets[j]; k < weights.offsets[j + 1]; ++k) {
      const std::uint32_t seeing = weights.rooms_reached[k];
      if (weights.weights[k] < cut.least[seeing]) continue;
      const double weight = weights.weights[k] * cut.factor[seeing];
      segments[{seeing, weights.rooms.of_cluster[j]}].push_back({j - first, static_cast<float>(weight)});
    }
  }
  return segments;
}

}  // namespace

Result<RoomTables> room_tables(const Model& model, const RoomWeights& weights) {
  static_assert(kNone == kernels::kNoRoom);
  if (auto checked = check(model, weights); !checked) return tl::unexpected<Error>(checked.error());
  const RoomCut cut = cut_of(weights);
  RoomTables tables;
  tables.rooms = weights.rooms.count;
  tables.room_of_cluster = weights.rooms.of_cluster;
  tables.first_cluster = cluster_offsets(model);
  for (std::size_t s = 0; s + 1 < tables.first_cluster.size(); ++s) {
    tables.first_segment.push_back(static_cast<std::uint32_t>(tables.segments.size()));
    for (const auto& [rooms, entries] :
         segments_of(weights, cut, tables.first_cluster[s], tables.first_cluster[s + 1])) {
      tables.segments.push_back({static_cast<kernels::uint>(tables.entries.size()),
                                 static_cast<kernels::uint>(entries.size()), rooms.first, rooms.second});
      tables.entries.insert(tables.entries.end(), entries.begin(), entries.end());
    }
  }
  tables.first_segment.push_back(static_cast<std::uint32_t>(tables.segments.size()));
  return tables;
}

std::vector<BufferRequirement> room_buffers(const RoomTables& tables, std::uint32_t lightings) {
  const VkDeviceSize sums = sum_count(tables) * lightings;
  const auto buffer = [](const char* name, VkDeviceSize bytes) {
    BufferRequirement needed =
        storage_requirement(name, std::max<VkDeviceSize>(bytes, sizeof(kernels::uvec4)));
    needed.usage |= VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    return needed;
  };
  return {buffer("room segments", tables.segments.size() * sizeof(kernels::uvec4)),
          buffer("room entries", tables.entries.size() * sizeof(RoomEntry)),
          buffer("rooms of clusters", tables.room_of_cluster.size() * sizeof(std::uint32_t)),
          buffer("room sums", sums * sizeof(kernels::vec4))};
}

UploadData room_upload(const RoomTables& tables, std::uint32_t lightings) {
  UploadData data;
  data.add_owned(kRoomSegments, 0, owned_bytes(tables.segments));
  data.add_owned(kRoomEntries, 0, owned_bytes(tables.entries));
  data.add_owned(kRoomOfCluster, 0, owned_bytes(tables.room_of_cluster));
  data.add_owned(kRoomSums, 0, std::vector<std::byte>(sum_count(tables) * lightings * sizeof(kernels::vec4)));
  return data;
}

}  // namespace relume
