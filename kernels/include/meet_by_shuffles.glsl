// SPDX-License-Identifier: MIT
//
// Eight invocations of a subgroup, each a lane of eight sums, meet: in each of three steps an invocation keeps
// the sums that have its own bit and adds what its partner has of them. That is the tree of include/lane_tree.glsl,
// because a + b = b + a to the bit; in the end each has one sum.
#ifndef RELUME_MEET_BY_SHUFFLES_GLSL
#define RELUME_MEET_BY_SHUFFLES_GLSL

#include "../shared/limits.h"
#include "lightings.glsl"

uint lane_of_subgroup() {
  return gl_SubgroupInvocationID & (kLanes - 1u);
}

/// Of the eight invocations that meet, the number of the first in its workgroup.
uint first_of_lanes() {
  return gl_SubgroupID * gl_SubgroupSize + (gl_SubgroupInvocationID & ~(kLanes - 1u));
}

/// Sums of the half that `upper` names, over two lanes; partners differ in `bit` of their number.
vec3 met(vec3 lower, vec3 higher, bool upper, uint bit) {
  const vec3 kept = upper ? higher : lower;
  const vec3 given = upper ? lower : higher;
  precise vec3 sum = kept + subgroupShuffle(given, gl_SubgroupInvocationID ^ bit);
  return sum;
}

/// Sum number `lane` of one lighting, of all lanes.
vec3 sum_of_lanes(vec3 sums[kLanes], uint lane) {
  const bool bit_2 = (lane & 4u) != 0u, bit_1 = (lane & 2u) != 0u, bit_0 = (lane & 1u) != 0u;
  const vec3 s0 = met(sums[0], sums[4], bit_2, 4u), s1 = met(sums[1], sums[5], bit_2, 4u);
  const vec3 s2 = met(sums[2], sums[6], bit_2, 4u), s3 = met(sums[3], sums[7], bit_2, 4u);
  const vec3 t0 = met(s0, s2, bit_1, 2u), t1 = met(s1, s3, bit_1, 2u);
  return met(t0, t1, bit_0, 1u);
}

/// The same of every lighting.
mat4x3 sums_of_lanes(mat4x3 sums[kLanes], uint lane) {
  mat4x3 met_sums = mat4x3(0.0);
  for (uint lighting = 0u; lighting < kLightings; ++lighting) {
    vec3 of_lighting[kLanes];
    for (uint i = 0u; i < kLanes; ++i) of_lighting[i] = sums[i][lighting];
    met_sums[lighting] = sum_of_lanes(of_lighting, lane);
  }
  return met_sums;
}

#endif
