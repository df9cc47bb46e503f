// SPDX-License-Identifier: MIT
//
// What a bounce makes of a row product: B = M + albedo (H + I).
#ifndef RELUME_BOUNCE_GLSL
#define RELUME_BOUNCE_GLSL

#include "lighting.glsl"
#include "radiosity.glsl"
#include "range.glsl"

void finish_row(uint row, vec3 irradiance) {
  const uint cluster = range.block_row + row;
  radiosity[range.first_sender + cluster] = vec4(reflect_and_emit(cluster, irradiance), 0.0);
}

#endif
