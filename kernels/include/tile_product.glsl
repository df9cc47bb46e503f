// SPDX-License-Identifier: MIT
//
// The lanes of include/row_product.glsl for the eight rows of a tile at once: an invocation is one lane of all of
// them, so that a column and its radiosity are read once for eight form factors and the codes of an entry in one
// load (two for f32). What follows brings the sums of a row's lanes together.
//
// Shaped for lavapipe: it has no branches but those that end a loop, so that a test before the body costs a whole
// turn, and a fetch is a call that drops all registers, so that those of a turn go before its arithmetic.
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

/// First row of the workgroup, from the first of the dispatch on.
uint first_row_of_workgroup() {
  return (gl_WorkGroupID.x * kSweeps + gl_WorkGroupID.y) * kWorkgroupSize;
}

/// The codes of an entry: of f32 rows 0 to 3 and 4 to 7, of unorm16 two, of sqrt8 four rows a word of `low`.
struct TileCodes {
  uvec4 low, high;
};

uvec4 code_vector(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(code_texels, int(index));
  return code_vectors[index];
}

uvec2 code_pair(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(code_texels, int(index)).xy;
  return code_pairs[index];
}

TileCodes tile_codes(uint entry) {
  if (kCodec == kCodecUnorm16) return TileCodes(code_vector(entry), uvec4(0u));
  if (kCodec == kCodecSqrt8) return TileCodes(uvec4(code_pair(entry), 0u, 0u), uvec4(0u));
  return TileCodes(code_vector(2u * entry), code_vector(2u * entry + 1u));
}

// By way of int, which every processor converts in one instruction.
float code_of_row(TileCodes codes, uint row) {
  if (kCodec == kCodecUnorm16) return float(int(half_word(codes.low[row / 2u], row)));
  if (kCodec == kCodecSqrt8) {
    const float root = float(int((codes.low[row / 4u] >> (8u * (row & 3u))) & 0xffu));
    return root * root;
  }
  return uintBitsToFloat(row < 4u ? codes.low[row & 3u] : codes.high[row & 3u]);
}

/// Entries of a lane in a turn.
const uint kTurn = 4u;

struct TileTurn {
  TileCodes codes[kTurn];
  mat4x3 b[kTurn];  ///< black where the tile has ended: +0 more does not change a sum
};

TileTurn fetch_turn(uint first, uint last) {
  TileTurn turn;
  uint columns_of_turn[kTurn];
  for (uint i = 0u; i < kTurn; ++i) columns_of_turn[i] = column_of(min(first + i * kLanes, last));
  for (uint i = 0u; i < kTurn; ++i) turn.codes[i] = tile_codes(min(first + i * kLanes, last));
  for (uint i = 0u; i < kTurn; ++i) {
    const mat4x3 b = scaled_radiosities_of(columns_of_turn[i]);
    const bool inside = first + i * kLanes <= last;
    for (uint lighting = 0u; lighting < kLightings; ++lighting)
      turn.b[i][lighting] = inside ? b[lighting] : vec3(0.0);
  }
  return turn;
}

/// The sums of lane `lane` of the rows of a tile, from 0 on.
void add_tile_lane(inout precise mat4x3 sums[kTileOfRows], uint tile, uint lane) {
  const uint end = tile_offset(tile + 1u);
  uint entry = tile_offset(tile);
  if (entry == end) return;
  do {
    const TileTurn turn = fetch_turn(entry + lane, end - 1u);
    for (uint row = 0u; row < kTileOfRows; ++row) {
      for (uint i = 0u; i < kTurn; ++i) {
        precise mat4x3 term = code_of_row(turn.codes[i], row) * turn.b[i];
        sums[row] = sums[row] + term;
      }
    }
    entry += kTurn * kLanes;
  } while (entry < end);
}

#endif
