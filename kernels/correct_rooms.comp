// SPDX-License-Identifier: MIT
//
// Adds to each cluster what it reflects of the irradiance of its room, no less than 0 and no more than anything can
// have.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/rooms.glsl"

void main() {
  const float most = uintBitsToFloat(range.first_row);
  uint cluster = gl_GlobalInvocationID.x;
  if (cluster >= range.count) return;
  do {
    const uint room = room_of_cluster[range.block_row + cluster];
    if (room != kNoRoom) {
      const uint sender = in_lighting(range.first_sender) + cluster;
      const vec3 corrected =
          radiosity[sender].rgb + albedo[cluster].rgb * room_sums[first_room() + room].rgb;
      radiosity[sender] = vec4(clamp(corrected, vec3(0.0), vec3(most)), 0.0);
    }
    cluster += gl_NumWorkGroups.x * kWorkgroupSize;
  } while (cluster < range.count);
}
