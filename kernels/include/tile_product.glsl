// SPDX-License-Identifier: MIT
//
// The lanes of include/row_product.glsl for the eight rows of a tile at once: an invocation is one lane of all of
// them, so that a column and its radiosity are read once for eight form factors and the codes of an entry in one
// load (two for f32). What follows brings the sums of a row's lanes together.
#ifndef RELUME_TILE_PRODUCT_GLSL
#define RELUME_TILE_PRODUCT_GLSL

#include "row_product.glsl"

layout(set = kBlockSet, binding = kCodeTexelsBinding) uniform usamplerBuffer code_texels;
layout(set = kBlockSet, binding = kValuesBinding, std430) readonly restrict buffer CodeVectors {
  uvec4 code_vectors[];
};
layout(set = kBlockSet, binding = kValuesBinding, std430) readonly restrict buffer CodePairs {
  uvec2 code_pairs[];
};

/// Of rows 0 to 3 and 4 to 7.
struct TileCodes {
  vec4 low, high;
};

uvec4 code_vector(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(code_texels, int(index));
  return code_vectors[index];
}

uvec2 code_pair(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(code_texels, int(index)).xy;
  return code_pairs[index];
}

// By way of int, which every processor converts in one instruction.
vec4 halves(uvec2 words) {
  return vec4(ivec4(words.x & 0xffffu, words.x >> 16, words.y & 0xffffu, words.y >> 16));
}

vec4 squared_bytes(uint word) {
  const vec4 roots = vec4(ivec4(word & 0xffu, (word >> 8) & 0xffu, (word >> 16) & 0xffu, word >> 24));
  return roots * roots;
}

TileCodes tile_codes(uint entry) {
  if (kCodec == kCodecUnorm16) {
    const uvec4 words = code_vector(entry);
    return TileCodes(halves(words.xy), halves(words.zw));
  }
  if (kCodec == kCodecSqrt8) {
    const uvec2 words = code_pair(entry);
    return TileCodes(squared_bytes(words.x), squared_bytes(words.y));
  }
  return TileCodes(uintBitsToFloat(code_vector(2u * entry)), uintBitsToFloat(code_vector(2u * entry + 1u)));
}

void add_code(inout precise vec3 lane_sum, float code, vec3 b) {
  precise vec3 term = code * b;
  lane_sum = lane_sum + term;
}

void add_tile_entry(inout precise vec3 sums[kTileOfRows], uint entry) {
  const vec3 b = radiosity_of(column_of(entry));
  const TileCodes codes = tile_codes(entry);
  add_code(sums[0], codes.low.x, b);
  add_code(sums[1], codes.low.y, b);
  add_code(sums[2], codes.low.z, b);
  add_code(sums[3], codes.low.w, b);
  add_code(sums[4], codes.high.x, b);
  add_code(sums[5], codes.high.y, b);
  add_code(sums[6], codes.high.z, b);
  add_code(sums[7], codes.high.w, b);
}

/// The sums of lane `lane` of the rows of a tile.
void add_tile_lane(inout precise vec3 sums[kTileOfRows], uint tile, uint lane) {
  uint entry = tile_offsets[tile];
  const uint end = tile_offsets[tile + 1u];
  for (; entry + 4u * kLanes <= end; entry += 4u * kLanes) {
    add_tile_entry(sums, entry + lane);
    add_tile_entry(sums, entry + kLanes + lane);
    add_tile_entry(sums, entry + 2u * kLanes + lane);
    add_tile_entry(sums, entry + 3u * kLanes + lane);
  }
  for (entry += lane; entry < end; entry += kLanes) add_tile_entry(sums, entry);
}

#endif
