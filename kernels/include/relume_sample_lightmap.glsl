// SPDX-License-Identifier: MIT
//
// For a renderer's own shaders: from a lightmap that compute/lightmap_pass.h wrote to what the camera sees of a diffuse
// surface. GLSL 1.30 and later, with or without Vulkan; it declares functions and one constant, all of which begin with
// relume_, and no bindings.
//
//   layout(set = 1, binding = 0) uniform sampler2D lightmap;
//   ...
//   vec2 at = relume_lightmap_uv(texcoord_1, chart_scale, chart_offset, vec2(textureSize(lightmap, 0)));
//   vec3 radiance = relume_diffuse_radiance(albedo, relume_sample_irradiance(lightmap, at)) + emitted;
//
// The lightmap holds irradiance in lux, linear Rec.709: indirect light alone, or with direct light, as the pass was told. A
// renderer that lights its surfaces itself asks for indirect light alone and adds its own. Charts are dilated by four texels:
// linear filtering and one mip level stay inside them. The sampler is linear and clamps to the edge.
//
// Normal maps: where the file was precomputed with --directional, a second image has the dominant direction d of the
// indirect irradiance in world space (`relume solve` writes SYSTEM.directional.exr; in a frame a LightmapPass of the format
// direction_rgba16f writes it). Then
//
//   vec3 d = texture(directions, at).xyz;
//   vec3 irradiance = relume_sample_irradiance(lightmap, at) * relume_bent_irradiance_factor(d, normal, shading_normal);
#ifndef RELUME_SAMPLE_LIGHTMAP_GLSL
#define RELUME_SAMPLE_LIGHTMAP_GLSL

/// As core/quantities.h: the radiance of a diffuse surface is its radiosity / pi.
const float relume_pi = 3.14159265358979;

/// Where a point of a chart (core/model.h, LightmapChart: scale and offset in lumels) lies in the lightmap, 1 = the whole image.
/// `uv` is of the set that the chart names; for charts made by Relume it is a coordinate in the whole lightmap already, and
/// lies where it says. Row 0 is v = 0. lightmaps.json has scale and offset divided by the size: there it is uv * scale + offset.
vec2 relume_lightmap_uv(vec2 uv, vec2 chart_scale, vec2 chart_offset, vec2 lightmap_size) {
  return (uv * chart_scale + chart_offset) / lightmap_size;
}

/// lux. In fragment shaders.
vec3 relume_sample_irradiance(sampler2D lightmap, vec2 at) {
  return texture(lightmap, at).rgb;
}

/// lux, of a mip level: in shaders without derivatives.
vec3 relume_sample_irradiance_level(sampler2D lightmap, vec2 at, float level) {
  return textureLod(lightmap, at, level).rgb;
}

/// d from the moments of the irradiance along x, y and z (GpuSolver::directional_irradiance) and the irradiance itself:
/// points to where most light comes from, in world space; its length, at most 1, tells how much of it. For shaders that read
/// the solver's buffer themselves.
vec3 relume_dominant_direction(vec3 along_x, vec3 along_y, vec3 along_z, vec3 irradiance) {
  const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
  float whole = dot(irradiance, luminance);
  if (!(whole > 0.0)) return vec3(0.0);
  vec3 d = vec3(dot(along_x, luminance), dot(along_y, luminance), dot(along_z, luminance)) / whole;
  return d / max(1.0, length(d));
}

/// By how much irradiance changes when the normal of a surface, `normal`, becomes `bent` (both unit, world space): 1 for
/// the normal itself, never negative, at most 4. As bent_irradiance_factor of core/directional_irradiance.h, where it is
/// derived: exact where a hemisphere is evenly bright, (1 + cos) / 2, and where light comes from one direction.
float relume_bent_irradiance_factor(vec3 d, vec3 normal, vec3 bent) {
  float even = 2.0 * (1.0 - length(d));
  float here = max(1e-6, even + dot(d, normal));
  return min(max(0.0, even + dot(d, bent)) / here, 4.0);
}

/// cd/m2 that a diffuse surface reflects, the same in all directions: albedo x irradiance / pi.
vec3 relume_diffuse_radiance(vec3 albedo, vec3 irradiance) {
  return albedo * irradiance / relume_pi;
}

#endif
