// SPDX-License-Identifier: MIT
//
// First moments of irradiance (core/directional_irradiance.h): three products of one row, with its form factors times the
// components of their directions, by eight invocations like a row (include/row_per_8_lanes.glsl). In the order of
// include/row_product.glsl, of terms (code x b) x component; the sum of the lanes times 1 / 511, then the scale of the row.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/row_product.glsl"

layout(set = kSystemSet, binding = kIrradianceBinding, std430) writeonly restrict buffer Irradiance {
  vec4 irradiance_of_row[];  // then, three times as many, the moments
};
layout(set = kBlockSet, binding = kRowScalesBinding, std430) readonly buffer Directions {
  uint scales_and_directions[];
};

const uint kAxes = 3u;

shared vec4 lane_sums[kAxes * kWorkgroupSize];

/// Times 511.
vec3 direction_at(uint index) {
  const int code = int(scales_and_directions[range.first_sender + index]);
  return vec3(bitfieldExtract(code, 0, 10), bitfieldExtract(code, 10, 10), bitfieldExtract(code, 20, 10));
}

void sum_lane(uint row, bool inside, uint lane) {
  precise vec3 sums[kAxes] = vec3[kAxes](vec3(0.0), vec3(0.0), vec3(0.0));
  const uint end = inside ? end_entry(row) : 0u;
  for (uint entry = inside ? first_entry(row) + lane : 0u; entry < end; entry += kLanes) {
    const uint index = entry * kTileRows + row % kTileRows;
    precise const vec3 arriving = code_at(index) * scaled_radiosity_of(gl_WorkGroupID.z, column_of(entry));
    const vec3 direction = direction_at(index);
    for (uint axis = 0u; axis < kAxes; ++axis) {
      precise const vec3 term = direction[axis] * arriving;
      sums[axis] = sums[axis] + term;
    }
  }
  for (uint axis = 0u; axis < kAxes; ++axis)
    lane_sums[axis * kWorkgroupSize + gl_LocalInvocationIndex] = vec4(sums[axis], 0.0);
}

vec3 sum_of_lanes(uint at) {
  return lane_tree(lane_sums[at].xyz, lane_sums[at + 1u].xyz, lane_sums[at + 2u].xyz, lane_sums[at + 3u].xyz,
                   lane_sums[at + 4u].xyz, lane_sums[at + 5u].xyz, lane_sums[at + 6u].xyz,
                   lane_sums[at + 7u].xyz);
}

void main() {
  const uint first = gl_LocalInvocationIndex & ~(kLanes - 1u);
  const uint lane = gl_LocalInvocationIndex - first;
  const uint index = gl_WorkGroupID.x * kRowsPerWorkgroup + first / kLanes;
  const uint row = range.first_row + index;
  const bool inside = index < range.count;
  sum_lane(row, inside, lane);
  memoryBarrierShared();
  barrier();
  if (!inside || lane >= kAxes) return;
  precise const vec3 sum = sum_of_lanes(lane * kWorkgroupSize + first) * (1.0 / 511.0);
  precise const vec3 moment = sum * scale_of_sum(row);
  const uint first_moment = first_of_lighting(gl_WorkGroupID.z, irradiance_of_row.length()) + range.block_row;
  irradiance_of_row[first_moment + kAxes * row + lane] = vec4(moment, 0.0);
}
