// SPDX-License-Identifier: MIT
//
// What a bounce makes of a row product: B = M + albedo (H + I).
#ifndef RELUME_BOUNCE_GLSL
#define RELUME_BOUNCE_GLSL

#include "lighting.glsl"
#include "radiosity.glsl"
#include "range.glsl"

void finish_row(uint row, mat4x3 irradiance) {
  const uint cluster = range.block_row + row;
  for (uint lighting = 0u; lighting < kLightings; ++lighting) {
    radiosity[first_of_lighting(lighting, radiosity.length()) + range.first_sender + cluster] =
        vec4(reflect_and_emit(lighting, cluster, irradiance[lighting]), 0.0);
  }
}

#endif
