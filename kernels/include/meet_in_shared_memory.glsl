// SPDX-License-Identifier: MIT
//
// Eight invocations of a workgroup, each a lane of one sum, meet in shared memory, one lighting after the other: right
// at any subgroup width.
#ifndef RELUME_MEET_IN_SHARED_MEMORY_GLSL
#define RELUME_MEET_IN_SHARED_MEMORY_GLSL

#include "../shared/limits.h"
#include "lane_tree.glsl"
#include "lightings.glsl"

shared vec4 lane_sums[kWorkgroupSize];

vec3 sum_of_lanes(uint first) {
  return lane_tree(lane_sums[first].xyz, lane_sums[first + 1u].xyz, lane_sums[first + 2u].xyz,
                   lane_sums[first + 3u].xyz, lane_sums[first + 4u].xyz, lane_sums[first + 5u].xyz,
                   lane_sums[first + 6u].xyz, lane_sums[first + 7u].xyz);
}

/// The sums of all lanes, for lane 0, whose number in the workgroup is `first`; `lane_sum`: those of this one.
mat4x3 meet(mat4x3 lane_sum, uint first) {
  mat4x3 sum = mat4x3(0.0);
  for (uint lighting = 0u; lighting < kLightings; ++lighting) {
    if (lighting > 0u) barrier();
    lane_sums[gl_LocalInvocationIndex] = vec4(lane_sum[lighting], 0.0);
    memoryBarrierShared();
    barrier();
    if (gl_LocalInvocationIndex == first) sum[lighting] = sum_of_lanes(first);
  }
  return sum;
}

#endif
