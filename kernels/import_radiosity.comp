// SPDX-License-Identifier: MIT
//
// Brings the radiosity of the senders that a system imports to where its 16-bit columns find it. A node above
// the systems is the mean of its parts by their shares, summed one after the other. What is not loaded is black.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/fetch.glsl"
#include "include/radiosity.glsl"
#include "include/range.glsl"
#include "include/sender_format.glsl"
#include "shared/pack_texel.h"

layout(set = kSolveSet, binding = kFirstSenderBinding, std430) readonly restrict buffer FirstSender {
  uint first_sender_of[];
};
layout(set = kSystemSet, binding = kImportsBinding, std430) readonly restrict buffer Imports {
  uvec4 imports[];
};
layout(set = kSystemSet, binding = kLocalRadiosityBinding, std430) writeonly restrict buffer LocalRadiosity {
  vec4 local_radiosity[];
};
layout(set = kSystemSet, binding = kLocalRadiosityBinding, std430) writeonly restrict buffer HalfRadiosity {
  uvec2 half_radiosity[];
};
layout(set = kSolveSet, binding = kFirstSenderTexelsBinding) uniform usamplerBuffer first_sender_texels;
layout(set = kSolveSet, binding = kRadiosityTexelsBinding) uniform samplerBuffer radiosity_texels;
layout(set = kSystemSet, binding = kImportTexelsBinding) uniform usamplerBuffer import_texels;

uint first_sender(uint system) {
  if (kFetch == kFetchTexels) return texelFetch(first_sender_texels, int(system)).x;
  return first_sender_of[system];
}

vec3 radiosity_of(uint system, uint sender) {
  const uint first = first_sender(system);
  if (first == kNotLoaded) return vec3(0.0);
  if (kFetch == kFetchTexels) return texelFetch(radiosity_texels, int(first + sender)).rgb;
  return radiosity[first + sender].rgb;
}

uvec4 import_record(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(import_texels, int(index));
  return imports[index];
}

/// No node has as many.
const uint kMostParts = 0xffffffffu;

vec3 sum_of_parts(uint first) {
  precise vec3 sum = vec3(0.0);
  uint next = first;
  for (uint k = 0u; k < kMostParts; ++k) {
    const uvec4 part = import_record(next);
    precise vec3 term = uintBitsToFloat(part.z) * radiosity_of(part.x, part.y);
    sum = sum + term;
    next = part.w;
    if (next == 0u) break;
  }
  return sum;
}

uint normal_half(float value) {
  const uint bits = pack_half(floatBitsToUint(value * kSenderScale));
  return bits < kSmallestNormalHalf ? 0u : bits;
}

void keep_radiosity(uint index, vec3 value) {
  if (kHalfSenders == 0u) {
    local_radiosity[index] = vec4(value, 0.0);
  } else {
    half_radiosity[index] =
        uvec2(normal_half(value.r) | (normal_half(value.g) << 16u), normal_half(value.b));
  }
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= range.count) return;
  do {
    keep_radiosity(index, sum_of_parts(index));
    index += gl_NumWorkGroups.x * kWorkgroupSize;
  } while (index < range.count);
}
