// SPDX-License-Identifier: MIT
//
// Coefficients of incident radiance at light probes: sums of Y(direction) x (solid angle x radiosity) over the
// list of a probe, by eight invocations like a row (include/row_product.glsl), times 1 / pi.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/lane_tree.glsl"
#include "include/local_radiosity.glsl"
#include "include/probe_harmonics.glsl"
#include "include/range.glsl"

layout(set = kBlockSet, binding = kProbeListsBinding, std430) readonly restrict buffer ProbeLists {
  uint probe_lists[];
};
layout(set = kBlockSet, binding = kProbeSendersBinding, std430) readonly restrict buffer ProbeSenders {
  uint probe_senders[];
};
layout(set = kBlockSet, binding = kProbeCoefficientsBinding, std430) writeonly restrict buffer Coefficients {
  vec4 coefficients[];
};

const float kInversePi = 0.318309886;

shared vec4 lane_sums[kProbeHarmonics * kWorkgroupSize];

void add_sender(uint entry, inout precise vec3 sums[kProbeHarmonics]) {
  const uint at = entry * kProbeSenderUints;
  const float solid_angle = uintBitsToFloat(probe_senders[at + 1u]);
  const vec3 direction = vec3(uintBitsToFloat(probe_senders[at + 2u]), uintBitsToFloat(probe_senders[at + 3u]),
                              uintBitsToFloat(probe_senders[at + 4u]));
  precise const vec3 arriving = solid_angle * scaled_radiosity_of(gl_WorkGroupID.z, probe_senders[at]);
  float y[kProbeHarmonics];
  mean_harmonics(direction, y);
  for (uint h = 0u; h < kProbeHarmonics; ++h) {
    precise const vec3 term = y[h] * arriving;
    sums[h] = sums[h] + term;
  }
}

void sum_lane(uint list, bool inside, uint lane) {
  precise vec3 sums[kProbeHarmonics];
  for (uint h = 0u; h < kProbeHarmonics; ++h) sums[h] = vec3(0.0);
  const uint end = inside ? probe_lists[list + 1u] : 0u;
  for (uint entry = inside ? probe_lists[list] + lane : 0u; entry < end; entry += kLanes) {
    add_sender(entry, sums);
  }
  for (uint h = 0u; h < kProbeHarmonics; ++h) {
    lane_sums[h * kWorkgroupSize + gl_LocalInvocationIndex] = vec4(sums[h], 0.0);
  }
}

vec3 sum_of_lanes(uint at) {
  return lane_tree(lane_sums[at].xyz, lane_sums[at + 1u].xyz, lane_sums[at + 2u].xyz, lane_sums[at + 3u].xyz,
                   lane_sums[at + 4u].xyz, lane_sums[at + 5u].xyz, lane_sums[at + 6u].xyz,
                   lane_sums[at + 7u].xyz);
}

void main() {
  const uint first = gl_LocalInvocationIndex & ~(kLanes - 1u);
  const uint lane = gl_LocalInvocationIndex - first;
  const uint index = gl_WorkGroupID.x * kProbesPerWorkgroup + first / kLanes;
  const uint list = (range.first_row + index) * kProbeListUints;
  const bool inside = index < range.count;
  sum_lane(list, inside, lane);
  memoryBarrierShared();
  barrier();
  if (!inside) return;
  const uint first_coefficient = first_of_lighting(gl_WorkGroupID.z, coefficients.length()) +
                                 probe_lists[list + 2u] * kProbeHarmonics;
  for (uint h = lane; h < kProbeHarmonics; h += kLanes) {
    precise const vec3 value = (kInversePi / kSenderScale) * sum_of_lanes(h * kWorkgroupSize + first);
    coefficients[first_coefficient + h] = vec4(value, 0.0);
  }
}
