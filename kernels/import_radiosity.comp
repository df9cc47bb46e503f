// SPDX-License-Identifier: MIT
//
// Brings the radiosity of the senders that a system imports to where its 16-bit columns find it. A leaf is
// copied; a node is the mean of its leaves by their shares, eight invocations to an import, summed like a
// row (include/row_product.glsl) of share x radiosity. A node above the systems has a range of leaves in each of
// them: each lane sums its part of every range, and then these sums, one after the other. What is not loaded is
// black.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/lane_tree.glsl"
#include "include/range.glsl"
#include "shared/bindings.h"

layout(set = kSolveSet, binding = kRadiosityInBinding, std430) readonly restrict buffer RadiosityIn {
  vec4 radiosity_in[];
};
layout(set = kSystemSet, binding = kImportsBinding, std430) readonly restrict buffer Imports {
  uvec4 imports[];
};
layout(set = kSystemSet, binding = kImportSharesBinding, std430) readonly restrict buffer ImportShares {
  float shares[];
};
layout(set = kSystemSet, binding = kLocalRadiosityBinding, std430) writeonly restrict buffer LocalRadiosity {
  vec4 local_radiosity[];
};

shared vec4 lane_sums[kWorkgroupSize];

vec3 range_sum(uvec4 leaves, uint lane) {
  precise vec3 sum = vec3(0.0);
  for (uint i = lane; i < leaves.y; i += kLanes) {
    precise vec3 term = shares[leaves.z + i] * radiosity_in[leaves.x + i].rgb;
    sum = sum + term;
  }
  return sum;
}

vec3 lane_sum(uvec4 node, uint lane) {
  if (node.w == 0u) return range_sum(node, lane);
  precise vec3 sum = vec3(0.0);
  for (uint k = 0u; k < node.w; ++k) sum = sum + range_sum(imports[node.x + k], lane);
  return sum;
}

void main() {
  const uint first = gl_LocalInvocationIndex & ~(kLanes - 1u);
  const uint lane = gl_LocalInvocationIndex - first;
  const uint index = gl_WorkGroupID.x * kRowsPerWorkgroup + first / kLanes;
  const bool inside = index < range.count;
  const uvec4 import_record = inside ? imports[index] : uvec4(0u);

  const bool node = import_record.y != 1u;
  lane_sums[gl_LocalInvocationIndex] = vec4(node ? lane_sum(import_record, lane) : vec3(0.0), 0.0);
  memoryBarrierShared();
  barrier();
  if (!inside || lane != 0u) return;
  if (!node) {
    local_radiosity[index] = radiosity_in[import_record.x];
    return;
  }
  const vec3 sum = lane_tree(lane_sums[first].xyz, lane_sums[first + 1u].xyz, lane_sums[first + 2u].xyz,
                             lane_sums[first + 3u].xyz, lane_sums[first + 4u].xyz, lane_sums[first + 5u].xyz,
                             lane_sums[first + 6u].xyz, lane_sums[first + 7u].xyz);
  local_radiosity[index] = vec4(sum, 0.0);
}
