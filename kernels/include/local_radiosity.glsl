// SPDX-License-Identifier: MIT
//
// The radiosity of the senders that a system imports, where its columns find it.
#ifndef RELUME_LOCAL_RADIOSITY_GLSL
#define RELUME_LOCAL_RADIOSITY_GLSL

#include "fetch.glsl"
#include "lightings.glsl"
#include "sender_format.glsl"

layout(set = kSystemSet, binding = kLocalRadiosityBinding, std430) readonly restrict buffer LocalRadiosity {
  vec4 local_radiosity[];
};
layout(set = kSystemSet, binding = kLocalRadiosityBinding, std430) readonly restrict buffer HalfRadiosity {
  uvec2 half_radiosity[];
};
layout(set = kSystemSet, binding = kLocalRadiosityTexelsBinding) uniform samplerBuffer local_radiosity_texels;

/// Times kSenderScale.
vec3 scaled_radiosity_of(uint lighting, uint column) {
  const uint index = column * kLightings + lighting;
  if (kFetch == kFetchTexels) return texelFetch(local_radiosity_texels, int(index)).rgb;
  if (kHalfSenders == 0u) return local_radiosity[index].rgb;
  const uvec2 halves = half_radiosity[index];
  return vec3(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y).x);
}

/// The same of every lighting.
mat4x3 scaled_radiosities_of(uint column) {
  mat4x3 b = mat4x3(0.0);
  for (uint lighting = 0u; lighting < kLightings; ++lighting)
    b[lighting] = scaled_radiosity_of(lighting, column);
  return b;
}

#endif
