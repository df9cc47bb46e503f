// SPDX-License-Identifier: MIT
//
// Adds to each cluster what it reflects of the irradiance of its room, no less than 0 and no more than anything can
// have.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/rooms.glsl"

void main() {
  const uint step_size = gl_NumWorkGroups.x * kWorkgroupSize;
  const float most = uintBitsToFloat(range.first_row);
  for (uint cluster = gl_GlobalInvocationID.x; cluster < range.count; cluster += step_size) {
    const uint room = room_of_cluster[range.block_row + cluster];
    if (room == kNoRoom) continue;
    const uint sender = in_lighting(range.first_sender) + cluster;
    const vec3 corrected =
        radiosity[sender].rgb + albedo[cluster].rgb * room_sums[first_room() + room].rgb;
    radiosity[sender] = vec4(clamp(corrected, vec3(0.0), vec3(most)), 0.0);
  }
}
