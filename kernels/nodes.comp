// SPDX-License-Identifier: MIT
//
// The nodes of a system's tree, or of the sky's: each is the mean of its leaves by their shares, summed by
// eight invocations like a row (include/row_product.glsl) of share x radiosity.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/lane_tree.glsl"
#include "include/radiosity.glsl"
#include "include/range.glsl"

layout(set = kSystemSet, binding = kNodesBinding, std430) readonly restrict buffer Nodes {
  uvec4 nodes[];
};
layout(set = kSystemSet, binding = kNodeSharesBinding, std430) readonly restrict buffer Shares {
  float shares[];
};

shared vec4 lane_sums[kWorkgroupSize];

vec3 lane_sum(uvec4 node, uint lane) {
  precise vec3 sum = vec3(0.0);
  for (uint i = lane; i < node.y; i += kLanes) {
    precise vec3 term = shares[node.z + i] * radiosity[range.first_sender + node.x + i].rgb;
    sum = sum + term;
  }
  return sum;
}

void main() {
  const uint first = gl_LocalInvocationIndex & ~(kLanes - 1u);
  const uint lane = gl_LocalInvocationIndex - first;
  const uint index = range.first_row + gl_WorkGroupID.x * kRowsPerWorkgroup + first / kLanes;
  const bool inside = index < range.first_row + range.count;
  const uvec4 node = inside ? nodes[index] : uvec4(0u);

  lane_sums[gl_LocalInvocationIndex] = vec4(lane_sum(node, lane), 0.0);
  memoryBarrierShared();
  barrier();
  if (!inside || lane != 0u) return;
  const vec3 sum = lane_tree(lane_sums[first].xyz, lane_sums[first + 1u].xyz, lane_sums[first + 2u].xyz,
                             lane_sums[first + 3u].xyz, lane_sums[first + 4u].xyz, lane_sums[first + 5u].xyz,
                             lane_sums[first + 6u].xyz, lane_sums[first + 7u].xyz);
  radiosity[range.first_sender + range.block_row + index] = vec4(sum, 0.0);
}
