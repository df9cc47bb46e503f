// SPDX-License-Identifier: MIT
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared/lightmap.h"
#include "shared/pack_texel.h"

layout(set = 0, binding = kLightmapImageBinding, r32ui) uniform writeonly restrict uimage2D lightmap;

uvec4 packed(uvec3 bits) {
  return uvec4(pack_rgb9e5(bits.r, bits.g, bits.b), 0u, 0u, 0u);
}

#include "include/lightmap_irradiance.glsl"
