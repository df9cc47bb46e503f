// SPDX-License-Identifier: MIT
//
// The share of light that gets along segments given by the host: eight words of the work buffer each (from,
// 0, to, 0), results in shares. For measurements and tests.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/direct_light.glsl"
#include "include/shadow_ray.glsl"

vec3 work_point(uint at) {
  return vec3(uintBitsToFloat(work[at]), uintBitsToFloat(work[at + 1u]), uintBitsToFloat(work[at + 2u]));
}

void main() {
  const uint ray = gl_GlobalInvocationID.x;
  if (ray >= range.count) return;
  const uint at = 8u * (range.first + ray);
  shares[range.first + ray] = shadow_transmittance(work_point(at), work_point(at + 4u));
}
