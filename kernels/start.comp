// SPDX-License-Identifier: MIT
//
// B0 = M + albedo H of the clusters of a system, into both halves.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/lighting.glsl"
#include "include/radiosity.glsl"
#include "include/range.glsl"

void main() {
  const uint lighting = gl_WorkGroupID.z, first = first_of_lighting(lighting, radiosity.length());
  uint cluster = gl_GlobalInvocationID.x;
  if (cluster >= range.count) return;
  do {
    const vec4 start = vec4(reflect_and_emit(lighting, cluster, vec3(0.0)), 0.0);
    radiosity[first + range.first_row + cluster] = start;
    radiosity[first + range.first_sender + cluster] = start;
    cluster += gl_NumWorkGroups.x * kWorkgroupSize;
  } while (cluster < range.count);
}
