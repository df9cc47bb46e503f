// SPDX-License-Identifier: MIT
//
// Albedo and exitance of the clusters of a system, from what the precompute stored and what the host sets per material or
// per cluster.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/bounded_color.glsl"
#include "shared/limits.h"
#include "shared/materials.h"

layout(local_size_x = kWorkgroupSize) in;

layout(push_constant) uniform Constants {
  MaterialConstants constants;
};

layout(set = 0, binding = kMaterialStoredBinding, std430) readonly restrict buffer Stored {
  uvec4 stored[];
};
layout(set = 0, binding = kMaterialStatesBinding, std430) readonly restrict buffer States {
  MaterialState states[];
};
layout(set = 0, binding = kMaterialAlbedoBinding, std430) writeonly restrict buffer Albedo {
  vec4 albedo[];
};
layout(set = 0, binding = kMaterialExitanceBinding, std430) writeonly restrict buffer Exitance {
  vec4 exitance[];
};

vec3 changed(vec3 color, vec4 state) {
  if (state.w == kReplaceStored) return state.rgb;
  if (state.w == kScaleStored) return color * state.rgb;
  return color;
}

void main() {
  uint cluster = gl_GlobalInvocationID.x;
  if (cluster >= constants.clusters) return;
  do {
    const uvec4 stored_albedo = stored[2u * cluster];
    const MaterialState state = states[constants.state_per_cluster != 0u ? cluster : stored_albedo.w];
    const vec3 reflects = changed(uintBitsToFloat(stored_albedo.rgb), state.albedo);
    const vec3 emits = changed(uintBitsToFloat(stored[2u * cluster + 1u].rgb), state.exitance);
    albedo[cluster] = vec4(bounded(reflects, constants.max_albedo), 0.0);
    exitance[cluster] = vec4(bounded(emits, kLargestExitance), 0.0);
    cluster += gl_NumWorkGroups.x * kWorkgroupSize;
  } while (cluster < constants.clusters);
}
