// SPDX-License-Identifier: MIT
//
// Nodes by eight invocations of a subgroup, which must have eight or more: they do eight nodes, one after the
// other, and meet by shuffles in one of them each.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "include/nodes.glsl"
#include "include/meet_by_shuffles.glsl"

void main() {
  const uint lane = lane_of_subgroup();
  const uint index = gl_WorkGroupID.x * kWorkgroupSize + first_of_lanes() + lane;
  const bool inside = index < range.count;
  const uvec4 own = inside ? node_record(range.first_row + index) : uvec4(0u);
  mat4x3 sums[kLanes];
  for (uint i = 0u; i < kLanes; ++i) {
    const uint holder = gl_SubgroupInvocationID - lane + i;
    const uvec4 node = uvec4(subgroupShuffle(own.xyz, holder), 0u);
    sums[i] = sums_of_parts(node, lane, kLanes);
  }
  const mat4x3 mean = sums_of_lanes(sums, lane);
  if (inside) write_node(own, mean);
}
