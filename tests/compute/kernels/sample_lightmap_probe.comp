// SPDX-License-Identifier: MIT
//
// What a renderer's shader would see of a lightmap, at given texels of a chart without scale.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "../../../kernels/include/relume_sample_lightmap.glsl"

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) readonly buffer Places {
  vec4 places[];  // xy: texel; z: albedo; w: angle by which the normal leans, below 0 in light from one direction
};
layout(set = 0, binding = 1, std430) writeonly buffer Radiance {
  vec4 radiance[];
};
layout(set = 0, binding = 2) uniform sampler2D lightmap;

void main() {
  const vec4 place = places[gl_GlobalInvocationID.x];
  const vec2 at = relume_lightmap_uv(place.xy, vec2(1.0), vec2(0.0), vec2(textureSize(lightmap, 0)));
  const vec3 d = place.w < 0.0 ? relume_dominant_direction(vec3(6.0), vec3(8.0), vec3(0.0), vec3(10.0))
                               : vec3(0.0, 2.0 / 3.0, 0.0);
  const float factor = relume_bent_irradiance_factor(d, vec3(0.0, 1.0, 0.0), vec3(sin(place.w), cos(place.w), 0.0));
  const vec3 irradiance = factor * relume_sample_irradiance_level(lightmap, at, 0.0);
  radiance[gl_GlobalInvocationID.x] = vec4(relume_diffuse_radiance(vec3(place.z), irradiance), 0.0);
}
