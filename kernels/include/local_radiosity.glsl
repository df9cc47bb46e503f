// SPDX-License-Identifier: MIT
//
// The radiosity of the senders that a system imports, where its columns find it.
#ifndef RELUME_LOCAL_RADIOSITY_GLSL
#define RELUME_LOCAL_RADIOSITY_GLSL

#include "fetch.glsl"
#include "sender_format.glsl"

layout(set = kSystemSet, binding = kLocalRadiosityBinding, std430) readonly restrict buffer LocalRadiosity {
  vec4 local_radiosity[];
};
layout(set = kSystemSet, binding = kLocalRadiosityBinding, std430) readonly restrict buffer HalfRadiosity {
  uvec2 half_radiosity[];
};
layout(set = kSystemSet, binding = kLocalRadiosityTexelsBinding) uniform samplerBuffer local_radiosity_texels;

/// Times kSenderScale.
vec3 scaled_radiosity_of(uint column) {
  if (kFetch == kFetchTexels) return texelFetch(local_radiosity_texels, int(column)).rgb;
  if (kHalfSenders == 0u) return local_radiosity[column].rgb;
  const uvec2 halves = half_radiosity[column];
  return vec3(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y).x);
}

#endif
