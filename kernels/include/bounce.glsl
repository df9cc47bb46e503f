// SPDX-License-Identifier: MIT
//
// What a bounce makes of a row product: B = M + albedo (H + I).
#ifndef RELUME_BOUNCE_GLSL
#define RELUME_BOUNCE_GLSL

#include "lighting.glsl"
#include "range.glsl"

layout(set = kSolveSet, binding = kRadiosityOutBinding, std430) writeonly restrict buffer RadiosityOut {
  vec4 radiosity_out[];
};

void finish_row(uint row, vec3 irradiance) {
  const uint cluster = range.first_cluster + range.block_row + row;
  radiosity_out[cluster] = vec4(reflect_and_emit(cluster, irradiance), 0.0);
}

#endif
