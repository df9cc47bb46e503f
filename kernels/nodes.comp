// SPDX-License-Identifier: MIT
//
// Nodes by eight invocations each, which meet in shared memory as the lanes of a row do
// (include/row_product.glsl): right at any subgroup width.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/lane_tree.glsl"
#include "include/nodes.glsl"

shared vec4 lane_sums[kWorkgroupSize];

void main() {
  const uint first = gl_LocalInvocationIndex & ~(kLanes - 1u);
  const uint lane = gl_LocalInvocationIndex - first;
  const uint index = range.first_row + gl_WorkGroupID.x * kRowsPerWorkgroup + first / kLanes;
  const bool inside = index < range.first_row + range.count;
  const uvec4 node = inside ? node_record(index) : uvec4(0u);

  lane_sums[gl_LocalInvocationIndex] = vec4(sum_of_parts(node, lane, kLanes), 0.0);
  memoryBarrierShared();
  barrier();
  if (!inside || lane != 0u) return;
  write_node(node, lane_tree(lane_sums[first].xyz, lane_sums[first + 1u].xyz, lane_sums[first + 2u].xyz,
                             lane_sums[first + 3u].xyz, lane_sums[first + 4u].xyz, lane_sums[first + 5u].xyz,
                             lane_sums[first + 6u].xyz, lane_sums[first + 7u].xyz));
}
