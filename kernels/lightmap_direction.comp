// SPDX-License-Identifier: MIT
//
// Where most of the indirect light of a texel comes from (core/directional_irradiance.h), of the irradiance and the
// moments of its lumels together.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared/lightmap.h"
#include "shared/pack_texel.h"

layout(set = 0, binding = kLightmapImageBinding, rgba16ui) uniform writeonly restrict uimage2D lightmap;

#include "include/lightmap.glsl"
#include "include/relume_sample_lightmap.glsl"

uvec4 packed(uvec3 bits) {
  return uvec4(pack_signed_half(bits.x), pack_signed_half(bits.y), pack_signed_half(bits.z), kHalfOne);
}

vec3 texel_value(uint first, uint end) {
  const uint rows = uint(irradiance.length()) / 4u;  // three moments for each
  vec3 sum = vec3(0.0);
  vec3 moments[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
  for (uint k = first; k < end; ++k) {
    const uint row = lumels[k];
    sum += irradiance[row].rgb;
    for (uint axis = 0u; axis < 3u; ++axis) moments[axis] += irradiance[rows + 3u * row + axis].rgb;
  }
  return relume_dominant_direction(moments[0], moments[1], moments[2], sum);
}
