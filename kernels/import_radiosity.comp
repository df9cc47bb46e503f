// SPDX-License-Identifier: MIT
//
// Brings the radiosity of the senders that a system imports to where its 16-bit columns find it. A node above
// the systems is the mean of its parts by their shares, summed one after the other. What is not loaded is black.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/fetch.glsl"
#include "include/lightings.glsl"
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

vec3 radiosity_of(uint lighting, uint system, uint sender) {
  const uint first = first_sender(system);
  if (first == kNotLoaded) return vec3(0.0);
  const uint index = first_of_lighting(lighting, radiosity.length()) + first + sender;
  if (kFetch == kFetchTexels) return texelFetch(radiosity_texels, int(index)).rgb;
  return radiosity[index].rgb;
}

uvec4 import_record(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(import_texels, int(index));
  return imports[index];
}

/// No node has as many.
const uint kMostParts = 0xffffffffu;

mat4x3 sums_of_parts(uint first) {
  precise mat4x3 sum = mat4x3(0.0);
  uint next = first;
  for (uint k = 0u; k < kMostParts; ++k) {
    const uvec4 part = import_record(next);
    for (uint lighting = 0u; lighting < kLightings; ++lighting) {
      precise vec3 term = uintBitsToFloat(part.z) * radiosity_of(lighting, part.x, part.y);
      sum[lighting] = sum[lighting] + term;
    }
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
    const mat4x3 sum = sums_of_parts(index);
    for (uint lighting = 0u; lighting < kLightings; ++lighting)
      keep_radiosity(index * kLightings + lighting, sum[lighting]);
    index += gl_NumWorkGroups.x * kWorkgroupSize;
  } while (index < range.count);
}
