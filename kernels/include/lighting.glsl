// SPDX-License-Identifier: MIT
#ifndef RELUME_LIGHTING_GLSL
#define RELUME_LIGHTING_GLSL

#include "../shared/bindings.h"
#include "fetch.glsl"
#include "lightings.glsl"

layout(set = kSystemSet, binding = kAlbedoBinding, std430) readonly restrict buffer Albedo {
  vec4 albedo[];
};
layout(set = kSystemSet, binding = kExitanceBinding, std430) readonly restrict buffer Exitance {
  vec4 exitance[];
};
layout(set = kSystemSet, binding = kDirectBinding, std430) readonly restrict buffer Direct {
  vec4 direct[];
};
layout(set = kSystemSet, binding = kAlbedoTexelsBinding) uniform samplerBuffer albedo_texels;
layout(set = kSystemSet, binding = kExitanceTexelsBinding) uniform samplerBuffer exitance_texels;
layout(set = kSystemSet, binding = kDirectTexelsBinding) uniform samplerBuffer direct_texels;

vec3 albedo_of(uint cluster) {
  if (kFetch == kFetchTexels) return texelFetch(albedo_texels, int(cluster)).rgb;
  return albedo[cluster].rgb;
}

vec3 exitance_of(uint lighting, uint cluster) {
  const uint index = first_of_lighting(lighting, exitance.length()) + cluster;
  if (kFetch == kFetchTexels) return texelFetch(exitance_texels, int(index)).rgb;
  return exitance[index].rgb;
}

vec3 direct_of(uint lighting, uint cluster) {
  const uint index = first_of_lighting(lighting, direct.length()) + cluster;
  if (kFetch == kFetchTexels) return texelFetch(direct_texels, int(index)).rgb;
  return direct[index].rgb;
}

/// B = M + albedo (H + I) of a cluster of the system.
vec3 reflect_and_emit(uint lighting, uint cluster, vec3 irradiance) {
  precise vec3 arriving = direct_of(lighting, cluster) + irradiance;
  precise vec3 reflected = albedo_of(cluster) * arriving;
  precise vec3 leaving = reflected + exitance_of(lighting, cluster);
  return leaving;
}

#endif
