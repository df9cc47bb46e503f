// SPDX-License-Identifier: MIT
//
// Body of a row kernel: eight invocations of a workgroup do a row, one lane each, and meet in shared memory,
// so that it is right at any subgroup width. The kernel defines finish_row(row in the block, product).
#include "meet_in_shared_memory.glsl"
#include "row_product.glsl"

mat4x3 lane_product(uint row, uint lane) {
  precise mat4x3 sum = mat4x3(0.0);
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

  mat4x3 lane_sum = mat4x3(0.0);
  if (inside) lane_sum = lane_product(row, lane);
  const mat4x3 sum = meet(lane_sum, first);
  if (inside && lane == 0u) finish_row(row, scaled(row, sum));
}
