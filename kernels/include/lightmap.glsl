// SPDX-License-Identifier: MIT
//
// Body of a lightmap kernel: one invocation does a texel. The kernel declares the image `lightmap` and defines
// packed(bits of floats) and texel_value(lumels of the texel).
#ifndef RELUME_LIGHTMAP_GLSL
#define RELUME_LIGHTMAP_GLSL

#include "../shared/lightmap.h"
#include "../shared/limits.h"
#include "../shared/pack_texel.h"

layout(local_size_x = kWorkgroupSize) in;

layout(push_constant) uniform LightmapConstants {
  LightmapRange range;
};

layout(set = 0, binding = kLightmapTexelsBinding, std430) readonly restrict buffer Texels {
  uvec2 texels[];
};
layout(set = 0, binding = kLightmapLumelsBinding, std430) readonly restrict buffer Lumels {
  uint lumels[];
};
layout(set = 0, binding = kLightmapIrradianceBinding, std430) readonly buffer Irradiance {
  vec4 irradiance[];
};
layout(set = 0, binding = kLightmapDirectBinding, std430) readonly buffer Direct {
  vec4 direct[];
};

uvec4 packed(uvec3 bits);
vec3 texel_value(uint first, uint end);

void main() {
  if (gl_GlobalInvocationID.x >= range.count) return;
  const uint texel = range.first + gl_GlobalInvocationID.x;
  const uvec2 record = texels[texel];
  const uvec3 bits = floatBitsToUint(texel_value(record.y, texels[texel + 1u].y));
  imageStore(lightmap, ivec2(record.x & 0xffffu, record.x >> 16), packed(bits));
}

#endif
