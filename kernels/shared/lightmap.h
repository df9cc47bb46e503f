// SPDX-License-Identifier: MIT
//
// What the lightmap kernels and compute/lightmap_pass.h share. Set 0 is the only one.
#ifndef RELUME_KERNELS_LIGHTMAP_H
#define RELUME_KERNELS_LIGHTMAP_H

#include "glsl_types.h"

RELUME_SHARED_BEGIN

// Two uints per texel that carries a value, and one record at the end: x + 65536 y; its first entry among the
// lumels.
const uint kLightmapTexelsBinding = 0u;
const uint kLightmapLumelsBinding =
    1u;  // uint: row of the system's gather matrix; a texel is the mean of its rows
// vec4 per gather row, lm/m2; for directions three more per gather row behind them all: moments.
const uint kLightmapIrradianceBinding = 2u;
const uint kLightmapDirectBinding = 3u;  // vec4 per gather row, lm/m2; read when adds_direct is 1
const uint kLightmapBuffers = 4u;
const uint kLightmapImageBinding = 4u;  // rgba16ui or r32ui view of the lightmap

/// Push constants: texels [first, first + count) of the list.
struct LightmapRange {
  uint first;
  uint count;
  uint adds_direct;  // 0 or 1
};

RELUME_SHARED_END

#endif
