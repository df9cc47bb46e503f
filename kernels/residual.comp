// SPDX-License-Identifier: MIT
//
// What the last bounce of a system changed: maxima over its clusters, first of an invocation, then in the workgroup, then over all of them.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/lightings.glsl"
#include "include/radiosity.glsl"
#include "include/range.glsl"

layout(set = kSystemSet, binding = kWeightsBinding, std430) readonly restrict buffer Weights {
  vec4 weights[];
};
layout(set = kSolveSet, binding = kResidualBinding, std430) restrict buffer Residual {
  ResidualRecord residuals[];
};

const uint kMaxima = 12u;
shared uint group_maxima[kMaxima];

void raise_group_maxima(uint first, uvec3 values) {
  atomicMax(group_maxima[first], values.x);
  atomicMax(group_maxima[first + 1u], values.y);
  atomicMax(group_maxima[first + 2u], values.z);
}

// Bits of non-negative floats order as these do, with NaN above all.
void raise(inout uvec3 maxima[4], uint cluster) {
  const uint first = first_of_lighting(gl_WorkGroupID.z, radiosity.length());
  const vec3 after = abs(radiosity[first + range.first_sender + cluster].rgb);
  const vec3 before = abs(radiosity[first + range.first_row + cluster].rgb);
  const vec3 change = abs(after - before);
  const vec3 weight = weights[cluster].rgb;
  maxima[0] = max(maxima[0], floatBitsToUint(change / weight));
  maxima[1] = max(maxima[1], floatBitsToUint(change));
  maxima[2] = max(maxima[2], floatBitsToUint(after / weight));
  maxima[3] = max(maxima[3], floatBitsToUint(after));
}

void raise_record() {
  const uint record = first_of_lighting(gl_WorkGroupID.z, residuals.length()) + range.block_row;
  atomicMax(residuals[record].weighted_change.x, group_maxima[0]);
  atomicMax(residuals[record].weighted_change.y, group_maxima[1]);
  atomicMax(residuals[record].weighted_change.z, group_maxima[2]);
  atomicMax(residuals[record].change.x, group_maxima[3]);
  atomicMax(residuals[record].change.y, group_maxima[4]);
  atomicMax(residuals[record].change.z, group_maxima[5]);
  atomicMax(residuals[record].weighted_radiosity.x, group_maxima[6]);
  atomicMax(residuals[record].weighted_radiosity.y, group_maxima[7]);
  atomicMax(residuals[record].weighted_radiosity.z, group_maxima[8]);
  atomicMax(residuals[record].radiosity.x, group_maxima[9]);
  atomicMax(residuals[record].radiosity.y, group_maxima[10]);
  atomicMax(residuals[record].radiosity.z, group_maxima[11]);
}

void main() {
  if (gl_LocalInvocationIndex < kMaxima) group_maxima[gl_LocalInvocationIndex] = 0u;
  memoryBarrierShared();
  barrier();
  // Maxima do not mind a cluster that comes twice: the last one stands in for those beyond it.
  const uint stride = gl_NumWorkGroups.x * kWorkgroupSize;
  const uint turns = (range.count + stride - 1u) / stride;
  uvec3 maxima[4] = uvec3[](uvec3(0u), uvec3(0u), uvec3(0u), uvec3(0u));
  for (uint turn = 0u; turn < turns; ++turn)
    raise(maxima, min(gl_GlobalInvocationID.x + turn * stride, range.count - 1u));
  for (uint i = 0u; i < 4u; ++i) raise_group_maxima(3u * i, maxima[i]);
  memoryBarrierShared();
  barrier();
  if (gl_LocalInvocationIndex == 0u) raise_record();
}
