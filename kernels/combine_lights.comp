// SPDX-License-Identifier: MIT
//
// Irradiance as the sum of what each light alone would give, times its colour, one light after the other.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared/light_cache.h"
#include "shared/limits.h"

layout(local_size_x = kWorkgroupSize) in;

layout(push_constant) uniform Constants {
  LightCacheConstants constants;
};

layout(set = 0, binding = kCachedResponsesBinding, std430) readonly restrict buffer Responses {
  vec4 responses[];
};
layout(set = 0, binding = kCachedColorsBinding, std430) readonly restrict buffer Colors {
  vec4 colors[];
};
layout(set = 0, binding = kCachedIrradianceBinding, std430) writeonly restrict buffer Irradiance {
  vec4 irradiance[];
};

void main() {
  uint row = gl_GlobalInvocationID.x;
  if (row >= constants.rows) return;
  do {
    precise vec3 sum = vec3(0.0);
    for (uint light = 0u; light < constants.lights; ++light) {
      precise vec3 term = colors[light].rgb * responses[light * constants.rows + row].rgb;
      sum = sum + term;
    }
    irradiance[row] = vec4(sum, 0.0);
    row += gl_NumWorkGroups.x * kWorkgroupSize;
  } while (row < constants.rows);
}
