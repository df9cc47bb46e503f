// SPDX-License-Identifier: MIT
//
// For a renderer's own shaders: light from light probes at points in free space, for what moves. GLSL 4.30 and
// later, with or without Vulkan; it declares functions and constants, all of which begin with relume_, and no
// bindings. The host defines two macros that read its buffers before it includes this:
//
//   layout(set = 1, binding = 1, std430) readonly buffer Volume { uint volume[]; };
//   layout(set = 1, binding = 2, std430) readonly buffer Coefficients { vec4 coefficients[]; };
//   #define RELUME_PROBE_VOLUME(i) volume[i]
//   #define RELUME_PROBE_COEFFICIENTS(i) coefficients[i]
//   #include "relume_sample_probes.glsl"
//   ...
//   RelumeProbes near = relume_find_probes(position - model_origin);
//   vec3 radiance = albedo * relume_probe_irradiance(near, normal) / pi;
//
// The volume is probe_volume_words (core/probe_volume.h), uploaded once; the coefficients are
// GpuSolver::probe_coefficients, which every frame may change, or a copy of them. They are without the light that
// comes from punctual lights directly, which the renderer adds as it does elsewhere.
//
// Points are metres relative to Model::origin. One that lies on a surface is lifted off it along its normal, by
// some centimetres, to the side that is asked about: weights of probes behind a wall are exactly 0 beyond it.
#ifndef RELUME_SAMPLE_PROBES_GLSL
#define RELUME_SAMPLE_PROBES_GLSL

const uint relume_no_probe = 0xffffffffu;
const uint relume_probe_cell_bit = 0x80000000u;
const uint relume_probe_axis_shift = 29u;
const uint relume_probe_child_mask = 0x1fffffffu;
const uint relume_probe_volume_header = 12u;
const uint relume_probe_cell_words = 14u;
const uint relume_probe_harmonics = 9u;
const float relume_probe_fade = 0.25;
const float relume_least_corner_weight = 1e-3;

/// Probes of the four corners of a cell at its lower end along z, and at its upper end. Weights add up to 1, or are
/// all 0 where no probe sees the point: `covered` tells.
struct RelumeProbes {
  uvec4 lower;
  uvec4 upper;
  vec4 lower_weights;
  vec4 upper_weights;
  bool covered;
};

vec4 relume_probe_volume_vec4(uint word) {
  return vec4(uintBitsToFloat(RELUME_PROBE_VOLUME(word)), uintBitsToFloat(RELUME_PROBE_VOLUME(word + 1u)),
              uintBitsToFloat(RELUME_PROBE_VOLUME(word + 2u)), uintBitsToFloat(RELUME_PROBE_VOLUME(word + 3u)));
}

/// The entry of the cell in which a point lies; its edges (m), and the point within it, 0 to 1.
uint relume_find_probe_cell(vec3 point, out vec3 edges, out vec3 within) {
  const vec4 lower = relume_probe_volume_vec4(0u);
  const vec4 across = relume_probe_volume_vec4(4u);
  edges = vec3(lower.w, across.xy);
  const uvec3 counts = uvec3(RELUME_PROBE_VOLUME(6u), RELUME_PROBE_VOLUME(7u), RELUME_PROBE_VOLUME(8u));
  const vec3 at = clamp((point - lower.xyz) / edges, vec3(0.0), vec3(counts));
  const vec3 root = min(floor(at), vec3(counts) - 1.0);
  const uvec3 r = uvec3(root);
  within = at - root;
  uint node = RELUME_PROBE_VOLUME(relume_probe_volume_header + r.x + counts.x * (r.y + counts.y * r.z));
  while ((node & relume_probe_cell_bit) == 0u) {
    const bvec3 axis = equal(uvec3(node >> relume_probe_axis_shift), uvec3(0u, 1u, 2u));
    const bool upper = 2.0 * dot(within, vec3(axis)) >= 1.0;
    within = mix(within, 2.0 * within - vec3(upper), axis);
    edges = mix(edges, 0.5 * edges, axis);
    node = RELUME_PROBE_VOLUME(relume_probe_volume_header + (node & relume_probe_child_mask) + uint(upper));
  }
  return node;
}

uvec4 relume_probe_volume_uvec4(uint word) {
  return uvec4(RELUME_PROBE_VOLUME(word), RELUME_PROBE_VOLUME(word + 1u), RELUME_PROBE_VOLUME(word + 2u),
               RELUME_PROBE_VOLUME(word + 3u));
}

/// What a plane leaves of four corners: bit p of their sides asks for the positive side, bit 8 + p for the other.
vec4 relume_left_by_plane(uvec4 sides, uint p, float towards) {
  const vec4 positive = mix(vec4(1.0), vec4(clamp(towards, 0.0, 1.0)), notEqual(sides >> p & 1u, uvec4(0u)));
  const vec4 negative =
      mix(vec4(1.0), vec4(clamp(-towards, 0.0, 1.0)), notEqual(sides >> (8u + p) & 1u, uvec4(0u)));
  return positive * negative;
}

/// What all planes of a cell leave of its corners.
void relume_cut_by_planes(uint cell, vec3 point, vec3 edges, inout vec4 lower, inout vec4 upper) {
  const uvec4 pairs = relume_probe_volume_uvec4(cell + 8u);
  const uvec4 lower_sides = uvec4(pairs.x & 0xffffu, pairs.x >> 16u, pairs.y & 0xffffu, pairs.y >> 16u);
  const uvec4 upper_sides = uvec4(pairs.z & 0xffffu, pairs.z >> 16u, pairs.w & 0xffffu, pairs.w >> 16u);
  const uint first_plane = RELUME_PROBE_VOLUME(10u) + 4u * RELUME_PROBE_VOLUME(cell + 12u);
  const uint planes = RELUME_PROBE_VOLUME(cell + 13u);
  for (uint p = 0u; p < planes; ++p) {
    const vec4 plane = relume_probe_volume_vec4(first_plane + 4u * p);
    const float fade = relume_probe_fade * dot(abs(plane.xyz), edges);
    const float towards = (dot(plane.xyz, point) + plane.w) / fade;
    lower *= relume_left_by_plane(lower_sides, p, towards);
    upper *= relume_left_by_plane(upper_sides, p, towards);
  }
}

/// The probes that speak for a point.
RelumeProbes relume_find_probes(vec3 point) {
  RelumeProbes found =
      RelumeProbes(uvec4(relume_no_probe), uvec4(relume_no_probe), vec4(0.0), vec4(0.0), false);
  vec3 edges;
  vec3 within;
  const uint node = relume_find_probe_cell(point, edges, within);
  if (node != relume_no_probe) {
    const uint cell = RELUME_PROBE_VOLUME(9u) + (node & ~relume_probe_cell_bit) * relume_probe_cell_words;
    found.lower = relume_probe_volume_uvec4(cell);
    found.upper = relume_probe_volume_uvec4(cell + 4u);
    const vec2 x = vec2(1.0 - within.x, within.x), y = vec2(1.0 - within.y, within.y);
    const vec4 level = x.xyxy * y.xxyy;
    vec4 lower = max(level * (1.0 - within.z), relume_least_corner_weight);
    vec4 upper = max(level * within.z, relume_least_corner_weight);
    lower = mix(lower, vec4(0.0), equal(found.lower, uvec4(relume_no_probe)));
    upper = mix(upper, vec4(0.0), equal(found.upper, uvec4(relume_no_probe)));
    relume_cut_by_planes(cell, point, edges, lower, upper);
    const float sum = dot(lower + upper, vec4(1.0));
    found.covered = sum > 0.0;
    if (found.covered) {
      found.lower_weights = lower / sum;
      found.upper_weights = upper / sum;
    }
  }
  return found;
}

/// What coefficient h is worth for the irradiance of a plane, over pi (R. Ramamoorthi, P. Hanrahan, An Efficient
/// Representation for Irradiance Environment Maps, 2001).
float relume_cosine_lobe(uint h) {
  return h == 0u ? 1.0 : h < 4u ? 2.0 / 3.0 : 0.25;
}

/// Real orthonormal harmonics of a unit direction, in the order of core/probe_coefficients.h.
float relume_harmonic(uint h, vec3 d) {
  switch (h) {
    case 0u:
      return 0.282094792;
    case 1u:
      return 0.488602512 * d.y;
    case 2u:
      return 0.488602512 * d.z;
    case 3u:
      return 0.488602512 * d.x;
    case 4u:
      return 1.09254843 * d.x * d.y;
    case 5u:
      return 1.09254843 * d.y * d.z;
    case 6u:
      return 0.315391565 * (3.0 * d.z * d.z - 1.0);
    case 7u:
      return 1.09254843 * d.x * d.z;
  }
  return 0.546274215 * (d.x * d.x - d.y * d.y);
}

/// Of four probes.
vec3 relume_probe_irradiance_of_four(uvec4 probes, vec4 weights, vec3 normal, uint harmonics) {
  vec3 sum = vec3(0.0);
  for (uint h = 0u; h < harmonics; ++h) {
    vec3 mean = vec3(0.0);
    if (weights.x > 0.0) mean += weights.x * RELUME_PROBE_COEFFICIENTS(probes.x * relume_probe_harmonics + h).rgb;
    if (weights.y > 0.0) mean += weights.y * RELUME_PROBE_COEFFICIENTS(probes.y * relume_probe_harmonics + h).rgb;
    if (weights.z > 0.0) mean += weights.z * RELUME_PROBE_COEFFICIENTS(probes.z * relume_probe_harmonics + h).rgb;
    if (weights.w > 0.0) mean += weights.w * RELUME_PROBE_COEFFICIENTS(probes.w * relume_probe_harmonics + h).rgb;
    sum += 3.14159265 * relume_cosine_lobe(h) * relume_harmonic(h, normal) * mean;
  }
  return sum;
}

/// lux that arrive on a plane of unit normal from the first `harmonics` coefficients: 9 (L2), or 4 (L1), which is
/// less exact and reads less than half. 0 where no probe sees the point.
vec3 relume_probe_irradiance_of(RelumeProbes near, vec3 normal, uint harmonics) {
  return max(relume_probe_irradiance_of_four(near.lower, near.lower_weights, normal, harmonics) +
                 relume_probe_irradiance_of_four(near.upper, near.upper_weights, normal, harmonics),
             vec3(0.0));
}

/// lux that arrive on a plane of unit normal.
vec3 relume_probe_irradiance(RelumeProbes near, vec3 normal) {
  return relume_probe_irradiance_of(near, normal, relume_probe_harmonics);
}

#endif
