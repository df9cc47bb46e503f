// SPDX-License-Identifier: MIT
//
// Body of a lightmap kernel: one invocation does a texel. The kernel declares the image `lightmap` and defines
// packed(colour). The mean over the lumels of a texel is their sum, one after the other, times 1 / number.
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

vec3 lumel_value(uint row) {
  precise vec3 value = irradiance[row].rgb;
  if (range.adds_direct != 0u) value = value + direct[row].rgb;
  return value;
}

vec3 mean_of_lumels(uint first, uint end) {
  precise vec3 sum = lumel_value(lumels[first]);
  if (end - first == 1u) return sum;
  for (uint k = first + 1u; k < end; ++k) sum = sum + lumel_value(lumels[k]);
  precise vec3 mean = sum * (1.0 / float(end - first));
  return mean;
}

void main() {
  if (gl_GlobalInvocationID.x >= range.count) return;
  const uint texel = range.first + gl_GlobalInvocationID.x;
  const uvec2 record = texels[texel];
  const uvec3 bits = floatBitsToUint(mean_of_lumels(record.y, texels[texel + 1u].y));
  imageStore(lightmap, ivec2(record.x & 0xffffu, record.x >> 16), packed(bits));
}

#endif
