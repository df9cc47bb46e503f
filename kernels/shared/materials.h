// SPDX-License-Identifier: MIT
//
// What the material kernels and compute/material_pass.h, screen_pass.h share. Set 0 is the only one.
#ifndef RELUME_KERNELS_MATERIALS_H
#define RELUME_KERNELS_MATERIALS_H

#include "glsl_types.h"

RELUME_SHARED_BEGIN

/// What becomes of a stored colour, in the w of a MaterialState's vectors.
const float kKeepStored = 0.0f;     // rgb means nothing
const float kReplaceStored = 1.0f;  // rgb is the value
const float kScaleStored = 2.0f;    // rgb multiplies it, so that what textures made of it stays

/// Albedo and exitance of a material, or of a cluster, as a host sets them.
struct MaterialState {
  vec4 albedo;
  // ---- 16 bytes
  vec4 exitance;  // lm/m2: pi x radiance
  // ---- 32 bytes
};

/// Exitance above is lowered to this, so that sums stay finite.
const float kLargestExitance = 1e30f;

// materials.comp
const uint kMaterialStoredBinding =
    0u;  // two uvec4 per cluster: bits of albedo, material; bits of exitance, 0
const uint kMaterialStatesBinding = 1u;    // MaterialState per material or per cluster
const uint kMaterialAlbedoBinding = 2u;    // vec4 per cluster
const uint kMaterialExitanceBinding = 3u;  // vec4 per cluster, lm/m2
const uint kMaterialBuffers = 4u;

struct MaterialConstants {
  uint clusters;
  uint state_per_cluster;  // 0: per material
  float max_albedo;
};

// screen.comp
const uint kScreenClustersBinding =
    0u;  // uvec4 per cluster of the screen: cluster, first sample, number of samples, 0
const uint kScreenSamplesBinding = 1u;   // three floats per sample: u, v, weight
const uint kScreenAlbedoBinding = 2u;    // vec4 per cluster
const uint kScreenExitanceBinding = 3u;  // vec4 per cluster, lm/m2
const uint kScreenBuffers = 4u;
const uint kScreenImageBinding = 4u;

struct ScreenConstants {
  vec4 factor;  // what a texel of 1 is worth; lm/m2 for exitance
  // ---- 16 bytes
  uint clusters;
  uint sets_albedo;  // 0: exitance
  float max_albedo;
};

RELUME_SHARED_END

#ifdef __cplusplus
namespace relume::kernels {
static_assert(sizeof(MaterialState) == 32);
static_assert(sizeof(MaterialConstants) == 12);
static_assert(sizeof(ScreenConstants) == 28);
}  // namespace relume::kernels
#endif

#endif
