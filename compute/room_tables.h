// SPDX-License-Identifier: MIT
//
// The tables of the level above the bounces (core/methods/room_correction.h) as kernels read them.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/host_device.h"
#include "compute/upload.h"
#include "core/methods/room_correction.h"
#include "core/model.h"
#include "core/result.h"
#include "kernels/shared/glsl_types.h"
#include "kernels/shared/limits.h"

namespace relume {

/// Rooms that the device corrects, at most: see largest_rooms.
inline constexpr std::uint32_t kMaxDeviceRooms = kernels::kMaxRooms;

/// Buffers, in the order of their bindings in kernels/shared/bindings.h.
enum RoomBuffer : std::uint32_t { kRoomSegments, kRoomEntries, kRoomOfCluster, kRoomSums, kRoomBuffers };

struct RoomEntry {
  std::uint32_t cluster = 0;  ///< of its system
  float weight = 0.0f;        ///< over the area of the room that sees it
};

struct RoomTables {
  std::uint32_t rooms = 0;
  std::vector<kernels::uvec4> segments;
  std::vector<RoomEntry> entries;
  std::vector<std::uint32_t> room_of_cluster;  ///< or kernels::kNoRoom
  std::vector<std::uint32_t> first_segment;    ///< per system, and the total
  std::vector<std::uint32_t> first_cluster;    ///< per system, and the total
};

/// `weights` are of the clusters of the systems that are loaded in `model`. Fails with usage when they are of
/// other clusters, or of more than kMaxDeviceRooms rooms.
Result<RoomTables> room_tables(const Model& model, const RoomWeights& weights);

/// For SolverOptions::lightings.
std::vector<BufferRequirement> room_buffers(const RoomTables& tables, std::uint32_t lightings = 1);

/// Refers to nothing; has no targets.
UploadData room_upload(const RoomTables& tables, std::uint32_t lightings);

}  // namespace relume
