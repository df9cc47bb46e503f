// SPDX-License-Identifier: MIT
//
// The nodes of a system's tree, or of the sky's: each is the mean of its leaves by weight, summed by eight
// invocations like a row (include/row_product.glsl) of weight x radiosity.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/lane_tree.glsl"
#include "include/radiosity.glsl"
#include "include/range.glsl"

layout(set = kSystemSet, binding = kNodesBinding, std430) readonly restrict buffer Nodes {
  uvec4 nodes[];
};
layout(set = kSystemSet, binding = kLeafWeightsBinding, std430) readonly restrict buffer LeafWeights {
  float leaf_weights[];
};

shared vec4 lane_sums[kWorkgroupSize];

vec3 lane_sum(uvec4 node, uint lane) {
  precise vec3 sum = vec3(0.0);
  for (uint leaf = node.x + lane; leaf < node.x + node.y; leaf += kLanes) {
    precise vec3 term = leaf_weights[leaf] * radiosity[range.first_sender + leaf].rgb;
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
  precise vec3 mean = sum * uintBitsToFloat(node.z);
  radiosity[range.first_sender + range.block_row + index] = vec4(mean, 0.0);
}
