// SPDX-License-Identifier: MIT
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared/lightmap.h"
#include "shared/pack_texel.h"

layout(set = 0, binding = kLightmapImageBinding, rgba16ui) uniform writeonly restrict uimage2D lightmap;

uvec4 packed(uvec3 bits) {
  return uvec4(pack_half(bits.r), pack_half(bits.g), pack_half(bits.b), kHalfOne);
}

#include "include/lightmap_irradiance.glsl"
