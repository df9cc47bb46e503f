// SPDX-License-Identifier: MIT
//
// Nodes by eight invocations each, which meet in shared memory as the lanes of a row do
// (include/row_product.glsl): right at any subgroup width.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/meet_in_shared_memory.glsl"
#include "include/nodes.glsl"

void main() {
  const uint first = gl_LocalInvocationIndex & ~(kLanes - 1u);
  const uint lane = gl_LocalInvocationIndex - first;
  const uint index = range.first_row + gl_WorkGroupID.x * kRowsPerWorkgroup + first / kLanes;
  const bool inside = index < range.first_row + range.count;
  const uvec4 node = inside ? node_record(index) : uvec4(0u);
  const mat4x3 mean = meet(sums_of_parts(node, lane, kLanes), first);
  if (inside && lane == 0u) write_node(node, mean);
}
