// SPDX-License-Identifier: MIT
//
// What combine_lights.comp and compute/light_cache.h share. Set 0 is the only one.
#ifndef RELUME_KERNELS_LIGHT_CACHE_H
#define RELUME_KERNELS_LIGHT_CACHE_H

#include "glsl_types.h"

RELUME_SHARED_BEGIN

const uint kCachedResponsesBinding = 0u;   // vec4 per row of each light, light after light: lm/m2
const uint kCachedColorsBinding = 1u;      // vec4 per light
const uint kCachedIrradianceBinding = 2u;  // vec4 per row, lm/m2
const uint kLightCacheBuffers = 3u;

struct LightCacheConstants {
  uint rows;
  uint lights;
};

RELUME_SHARED_END

#endif
