// SPDX-License-Identifier: MIT
//
// The share of light that gets along a segment: 0 behind anything opaque, else the product of what all sheets
// on the way let through (core/opacity.h).
//
// Boxes are larger than their triangles by more than rounding can miss (kBvhMargin). Triangles are met by the
// signs of three edge functions of corners relative to the origin of the ray, each computed so that the
// triangles on both sides of an edge get the same number (Embree's robust intersector; J. Plücker coordinates
// of ray and edge): nothing passes between neighbours.
#ifndef RELUME_SHADOW_RAY_GLSL
#define RELUME_SHADOW_RAY_GLSL

#include "../shared/bindings.h"
#include "../shared/direct_light.h"

layout(constant_id = kTreeFetchConstant) const uint kTreeFetch = kFetchStorage;

layout(set = 0, binding = kBvhNodesBinding, std430) readonly restrict buffer BvhNodes {
  uvec4 bvh_nodes[];
};
layout(set = 0, binding = kBvhTrianglesBinding, std430) readonly restrict buffer BvhTriangles {
  uvec4 bvh_triangles[];
};
layout(set = 0, binding = kOpacityBinding, std430) readonly restrict buffer OpacityWords {
  uint opacity_words[];
};
layout(set = 0, binding = kBvhNodeTexelsBinding) uniform usamplerBuffer bvh_node_texels;
layout(set = 0, binding = kBvhTriangleTexelsBinding) uniform usamplerBuffer bvh_triangle_texels;

const uint kNoChild = 0xffffffffu;
const uint kStackSize = 64u;

uvec4 node_words(uint index) {
  if (kTreeFetch == kFetchTexels) return texelFetch(bvh_node_texels, int(index));
  return bvh_nodes[index];
}

uvec4 triangle_words(uint index) {
  if (kTreeFetch == kFetchTexels) return texelFetch(bvh_triangle_texels, int(index));
  return bvh_triangles[index];
}

/// As wrapped_texel of core/opacity.h.
uint wrapped_texel(float t, uint mode, uint size) {
  if (isnan(t) || isinf(t)) return 0u;
  if (mode == 0u) t -= floor(t);
  if (mode == 1u) {
    t -= 2.0 * floor(t * 0.5);
    if (t > 1.0) t = 2.0 - t;
  }
  return min(uint(clamp(t, 0.0, 1.0) * float(size)), size - 1u);
}

/// Opacity of a listed triangle. Words: first of the maps, first of the texels; then OpacityTriangle, 11 words
/// each; OpacityMap, 8 each; texels, four to a word.
float opacity_at(uint listed, float u, float v) {
  const uint at = 2u + 11u * listed;
  const uint map = opacity_words[0] + 8u * opacity_words[at + 1u];
  vec3 corner[3];
  for (uint k = 0u; k < 3u; ++k) {
    corner[k] = vec3(uintBitsToFloat(opacity_words[at + 2u + 3u * k]),
                     uintBitsToFloat(opacity_words[at + 3u + 3u * k]),
                     uintBitsToFloat(opacity_words[at + 4u + 3u * k]));
  }
  const vec3 point = corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]);
  float alpha = point.z;
  const uint width = opacity_words[map + 3u], height = opacity_words[map + 4u];
  if (width > 0u) {
    const uint x = wrapped_texel(point.x, opacity_words[map + 5u], width);
    const uint y = wrapped_texel(point.y, opacity_words[map + 6u], height);
    const uint texel = opacity_words[map + 7u] + y * width + x;
    alpha *= float((opacity_words[opacity_words[1] + (texel >> 2)] >> (8u * (texel & 3u))) & 0xffu) / 255.0;
  }
  const float solid = uintBitsToFloat(opacity_words[map + 2u]);
  if (opacity_words[map] == 1u) return alpha * solid;
  return alpha >= uintBitsToFloat(opacity_words[map + 1u]) ? solid : 0.0;
}

/// What is left of `transmittance` behind triangle `index` of the leaves, for the ray from `origin` by all of
/// `way`.
float behind_triangle(uint index, vec3 origin, vec3 way, float transmittance) {
  const uvec4 first = triangle_words(3u * index);
  const vec3 v0 = uintBitsToFloat(first.xyz) - origin;
  const vec3 v1 = uintBitsToFloat(triangle_words(3u * index + 1u).xyz) - origin;
  const vec3 v2 = uintBitsToFloat(triangle_words(3u * index + 2u).xyz) - origin;
  const vec3 e0 = v2 - v0, e1 = v0 - v1, e2 = v1 - v2;
  precise float u = dot(cross(e0, v2 + v0), way);
  precise float v = dot(cross(e1, v0 + v1), way);
  precise float w = dot(cross(e2, v1 + v2), way);
  precise float sum = u + v + w;
  const float slack = abs(sum) * 1.1920929e-7;
  if (min(u, min(v, w)) < -slack && max(u, max(v, w)) > slack) return transmittance;
  const vec3 a = cross(e1, e0), b = cross(e2, e1);
  // The normal from the pair of edges with less rounding.
  const bvec3 pick = lessThan(abs(e1.yzx * e0.zxy), abs(e2.yzx * e1.zxy));
  const vec3 normal = mix(b, a, pick);
  const float facing = 2.0 * dot(normal, way);
  const float distance = 2.0 * dot(v0, normal);
  if (facing == 0.0 || distance * facing < 0.0 || abs(distance) > abs(facing)) return transmittance;
  const uint listed = first.w;
  if (listed == 0u) return 0.0;
  return transmittance * (1.0 - opacity_at(listed - 1u, min(u / sum, 1.0), min(v / sum, 1.0)));
}

/// Child k of four in a word of 8-bit numbers.
vec4 unpacked(uint word) {
  return vec4(float(word & 0xffu), float((word >> 8) & 0xffu), float((word >> 16) & 0xffu),
              float(word >> 24));
}

/// Where the ray enters and leaves the four slabs of an axis.
void clip_axis(float start, float inverse, uint exponent, uint lower, uint upper, inout vec4 enter,
               inout vec4 leave) {
  const float step_size = uintBitsToFloat(exponent << 23) * inverse;
  const vec4 a = unpacked(inverse < 0.0 ? upper : lower) * step_size + vec4(start * inverse);
  const vec4 b = unpacked(inverse < 0.0 ? lower : upper) * step_size + vec4(start * inverse);
  enter = max(enter, a);
  leave = min(leave, b);
}

/// 1 / x, and a finite number of its sign where x is nearly 0.
float safe_inverse(float x) {
  return 1.0 / (abs(x) < 1e-18 ? (x < 0.0 ? -1e-18 : 1e-18) : x);
}

float shadow_transmittance(vec3 from, vec3 to) {
  const vec3 way = to - from;
  const vec3 inverse = vec3(safe_inverse(way.x), safe_inverse(way.y), safe_inverse(way.z));
  uint stack[kStackSize];
  uint depth = 0u;
  uint next = 0u;
  float transmittance = 1.0;
  while (next != kNoChild) {
    while ((next & 0x80000000u) == 0u) {
      const uvec4 head = node_words(4u * next);
      const uvec4 middle = node_words(4u * next + 1u);
      const uvec4 tail = node_words(4u * next + 2u);
      const uvec4 rest = node_words(4u * next + 3u);
      const vec3 start = uintBitsToFloat(head.xyz) - from;
      vec4 enter = vec4(0.0), leave = vec4(1.0);
      clip_axis(start.x, inverse.x, head.w & 0xffu, middle.x, middle.w, enter, leave);
      clip_axis(start.y, inverse.y, (head.w >> 8) & 0xffu, middle.y, tail.x, enter, leave);
      clip_axis(start.z, inverse.z, (head.w >> 16) & 0xffu, middle.z, tail.y, enter, leave);
      const uvec4 child = uvec4(tail.z, tail.w, rest.x, rest.y);
      const bvec4 met = lessThanEqual(enter, leave * 1.0000005);
      next = kNoChild;
      for (uint k = 0u; k < 4u; ++k) {
        if (!met[k] || child[k] == kNoChild) continue;
        if (next != kNoChild) stack[depth++] = next;
        next = child[k];
      }
      if (next == kNoChild && depth > 0u) next = stack[--depth];
    }
    if (next == kNoChild) break;
    const uint first = next & 0x1fffffffu;
    const uint end = first + ((next >> 29) & 3u) + 1u;
    for (uint index = first; index < end && transmittance > 0.0; ++index)
      transmittance = behind_triangle(index, from, way, transmittance);
    if (transmittance <= 0.0) return 0.0;
    next = depth > 0u ? stack[--depth] : kNoChild;
  }
  return transmittance;
}

#endif
