// SPDX-License-Identifier: MIT
//
// Body of a row kernel: eight invocations of a workgroup do a row, one lane each, and meet in shared memory,
// so that it is right at any subgroup width. The kernel defines finish_row(row in the block, product).
#include "row_product.glsl"

shared vec4 lane_sums[kWorkgroupSize];

vec3 lane_product(uint row, uint lane) {
  precise vec3 sum = vec3(0.0);
  const uint end = end_entry(row);
  for (uint entry = first_entry(row) + lane; entry < end; entry += kLanes) add_entry(sum, row, entry);
  return sum;
}

void main() {
  const uint first = gl_LocalInvocationIndex & ~(kLanes - 1u);
  const uint lane = gl_LocalInvocationIndex - first;
  const uint index = gl_WorkGroupID.x * kRowsPerWorkgroup + first / kLanes;
  const uint row = range.first_row + index;
  const bool inside = index < range.count;

  lane_sums[gl_LocalInvocationIndex] = vec4(inside ? lane_product(row, lane) : vec3(0.0), 0.0);
  memoryBarrierShared();
  barrier();
  if (!inside || lane != 0u) return;
  finish_row(row, row_result(row, lane_sums[first].xyz, lane_sums[first + 1u].xyz, lane_sums[first + 2u].xyz,
                             lane_sums[first + 3u].xyz, lane_sums[first + 4u].xyz, lane_sums[first + 5u].xyz,
                             lane_sums[first + 6u].xyz, lane_sums[first + 7u].xyz));
}
