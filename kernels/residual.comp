// SPDX-License-Identifier: MIT
//
// What the last bounce changed: maxima over all clusters, first in the workgroup, then over all of them.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/range.glsl"
#include "shared/bindings.h"

layout(set = kSolveSet, binding = kRadiosityInBinding, std430) readonly restrict buffer RadiosityIn {
  vec4 radiosity_in[];
};
layout(set = kSolveSet, binding = kRadiosityOutBinding, std430) readonly restrict buffer RadiosityOut {
  vec4 radiosity_out[];
};
layout(set = kSolveSet, binding = kWeightsBinding, std430) readonly restrict buffer Weights {
  vec4 weights[];
};
layout(set = kSolveSet, binding = kResidualBinding, std430) restrict buffer Residual {
  ResidualRecord residual;
};

const uint kMaxima = 12u;
shared uint group_maxima[kMaxima];

void raise_group_maxima(uint first, vec3 values) {
  atomicMax(group_maxima[first], floatBitsToUint(values.x));
  atomicMax(group_maxima[first + 1u], floatBitsToUint(values.y));
  atomicMax(group_maxima[first + 2u], floatBitsToUint(values.z));
}

void raise_record() {
  atomicMax(residual.weighted_change.x, group_maxima[0]);
  atomicMax(residual.weighted_change.y, group_maxima[1]);
  atomicMax(residual.weighted_change.z, group_maxima[2]);
  atomicMax(residual.change.x, group_maxima[3]);
  atomicMax(residual.change.y, group_maxima[4]);
  atomicMax(residual.change.z, group_maxima[5]);
  atomicMax(residual.weighted_radiosity.x, group_maxima[6]);
  atomicMax(residual.weighted_radiosity.y, group_maxima[7]);
  atomicMax(residual.weighted_radiosity.z, group_maxima[8]);
  atomicMax(residual.radiosity.x, group_maxima[9]);
  atomicMax(residual.radiosity.y, group_maxima[10]);
  atomicMax(residual.radiosity.z, group_maxima[11]);
}

void main() {
  if (gl_LocalInvocationIndex < kMaxima) group_maxima[gl_LocalInvocationIndex] = 0u;
  memoryBarrierShared();
  barrier();
  const uint step_size = gl_NumWorkGroups.x * kWorkgroupSize;
  for (uint cluster = gl_GlobalInvocationID.x; cluster < range.count; cluster += step_size) {
    const vec3 after = abs(radiosity_out[cluster].rgb);
    const vec3 change = abs(radiosity_out[cluster].rgb - radiosity_in[cluster].rgb);
    raise_group_maxima(0u, change / weights[cluster].rgb);
    raise_group_maxima(3u, change);
    raise_group_maxima(6u, after / weights[cluster].rgb);
    raise_group_maxima(9u, after);
  }
  memoryBarrierShared();
  barrier();
  if (gl_LocalInvocationIndex == 0u) raise_record();
}
