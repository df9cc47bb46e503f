// SPDX-License-Identifier: MIT
//
// The level above the bounces: one irradiance per room (core/methods/room_correction.h). What its kernels share.
#ifndef RELUME_ROOMS_GLSL
#define RELUME_ROOMS_GLSL

#include "../shared/bindings.h"
#include "lightings.glsl"
#include "radiosity.glsl"
#include "range.glsl"

layout(set = kBlockSet, binding = kRoomSegmentsBinding, std430) readonly restrict buffer RoomSegments {
  uvec4 segments[];
};
layout(set = kBlockSet, binding = kRoomEntriesBinding, std430) readonly restrict buffer RoomEntries {
  uvec2 entries[];
};
layout(set = kBlockSet, binding = kRoomOfClusterBinding, std430) readonly restrict buffer RoomOfCluster {
  uint room_of_cluster[];
};
layout(set = kBlockSet, binding = kRoomSumsBinding, std430) restrict buffer RoomSums {
  vec4 room_sums[];
};
layout(set = kSystemSet, binding = kAlbedoBinding, std430) readonly restrict buffer Albedo {
  vec4 albedo[];
};

/// The irradiance of room 0 in the lighting of the workgroup.
uint first_room() {
  return first_of_lighting(gl_WorkGroupID.z, room_sums.length());
}

/// Of the two sums of a pair in it, the first; `seen`: a room, or what is above all of them for none.
uint pair_sums(uint system, uint seeing, uint seen) {
  const uint pair = seeing * (kMaxRooms + 1u) + min(seen, kMaxRooms);
  return first_room() + kMaxRooms + 2u * (system * kRoomPairs + pair);
}

/// Sender 0 in it, of that of lighting 0.
uint in_lighting(uint first_sender) {
  return first_of_lighting(gl_WorkGroupID.z, radiosity.length()) + first_sender;
}

#endif
