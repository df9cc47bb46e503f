// SPDX-License-Identifier: MIT
//
// B0 = M + albedo H, into both halves. Their sky patches are uploaded.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/lighting.glsl"
#include "include/range.glsl"

layout(set = kSolveSet, binding = kRadiosityInBinding, std430) writeonly restrict buffer RadiosityIn {
  vec4 radiosity_in[];
};
layout(set = kSolveSet, binding = kRadiosityOutBinding, std430) writeonly restrict buffer RadiosityOut {
  vec4 radiosity_out[];
};

void main() {
  const uint step_size = gl_NumWorkGroups.x * kWorkgroupSize;
  for (uint cluster = gl_GlobalInvocationID.x; cluster < range.count; cluster += step_size) {
    const vec4 radiosity = vec4(reflect_and_emit(cluster, vec3(0.0)), 0.0);
    radiosity_in[cluster] = radiosity;
    radiosity_out[cluster] = radiosity;
  }
}
