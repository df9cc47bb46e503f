// SPDX-License-Identifier: MIT
#ifndef RELUME_LIGHTING_GLSL
#define RELUME_LIGHTING_GLSL

#include "../shared/bindings.h"

layout(set = kSystemSet, binding = kAlbedoBinding, std430) readonly restrict buffer Albedo {
  vec4 albedo[];
};
layout(set = kSystemSet, binding = kExitanceBinding, std430) readonly restrict buffer Exitance {
  vec4 exitance[];
};
layout(set = kSystemSet, binding = kDirectBinding, std430) readonly restrict buffer Direct {
  vec4 direct[];
};

/// B = M + albedo (H + I) of a cluster of the system.
vec3 reflect_and_emit(uint cluster, vec3 irradiance) {
  precise vec3 arriving = direct[cluster].rgb + irradiance;
  precise vec3 reflected = albedo[cluster].rgb * arriving;
  precise vec3 leaving = reflected + exitance[cluster].rgb;
  return leaving;
}

#endif
