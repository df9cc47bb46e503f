// SPDX-License-Identifier: MIT
//
// What a bounce makes of a row product: B = M + albedo (H + I).
#ifndef RELUME_BOUNCE_GLSL
#define RELUME_BOUNCE_GLSL

#include "lighting.glsl"
#include "range.glsl"

layout(set = kSystemSet, binding = kSystemRadiosityBinding, std430) writeonly restrict buffer SystemRadiosity {
  vec4 system_radiosity[];
};

void finish_row(uint row, vec3 irradiance) {
  const uint system_row = range.block_row + row;
  system_radiosity[system_row] = vec4(reflect_and_emit(range.first_cluster + system_row, irradiance), 0.0);
}

#endif
