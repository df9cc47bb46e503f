// SPDX-License-Identifier: MIT
//
// Body of a row kernel: eight invocations of a workgroup do a row, one lane each, and meet in shared memory,
// so that it is right at any subgroup width. The kernel defines finish_row(row in the block, product).
#include "row_product.glsl"

shared vec4 lane_sums[kWorkgroupSize];

mat4x3 lane_product(uint row, uint lane) {
  precise mat4x3 sum = mat4x3(0.0);
  const uint end = end_entry(row);
  for (uint entry = first_entry(row) + lane; entry < end; entry += kLanes) add_entry(sum, row, entry);
  return sum;
}

/// `first`: the invocation that has lane 0.
vec3 sum_of_lanes(uint first) {
  return lane_tree(lane_sums[first].xyz, lane_sums[first + 1u].xyz, lane_sums[first + 2u].xyz,
                   lane_sums[first + 3u].xyz, lane_sums[first + 4u].xyz, lane_sums[first + 5u].xyz,
                   lane_sums[first + 6u].xyz, lane_sums[first + 7u].xyz);
}

void main() {
  const uint first = gl_LocalInvocationIndex & ~(kLanes - 1u);
  const uint lane = gl_LocalInvocationIndex - first;
  const uint index = gl_WorkGroupID.x * kRowsPerWorkgroup + first / kLanes;
  const uint row = range.first_row + index;
  const bool inside = index < range.count;

  mat4x3 sums = mat4x3(0.0);
  if (inside) sums = lane_product(row, lane);
  mat4x3 product = mat4x3(0.0);
  for (uint lighting = 0u; lighting < kLightings; ++lighting) {
    if (lighting > 0u) barrier();
    lane_sums[gl_LocalInvocationIndex] = vec4(sums[lighting], 0.0);
    memoryBarrierShared();
    barrier();
    if (lane == 0u) product[lighting] = sum_of_lanes(first);
  }
  if (inside && lane == 0u) finish_row(row, scaled(row, product));
}
