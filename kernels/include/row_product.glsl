// SPDX-License-Identifier: MIT
//
// The product of one matrix row with the local radiosity of every lighting, in the one summation order that all kernels share,
// so that every kernel, subgroup width and slicing gives the same bits:
//
//   lane k of 8   s_k = 0, then + code * b of entry k, k + 8, k + 16, ... of the row, one after the other
//   the row       sum = ((s_0 + s_4) + (s_2 + s_6)) + ((s_1 + s_5) + (s_3 + s_7))
//   f32           product = sum * row_scale, code = the stored float
//   unorm16       product = sum * (row_scale * (1 / 65535)), code = the stored integer
//   sqrt8         product = sum * (row_scale * (1 / 65025)), code = the square of the stored integer
//   half senders  b = the half-precision number, the scale of the row times 1 / kSenderScale
//
// The entries of a row are the columns of its tile, zeros included.
//
// Each product and each addition is rounded on its own (`precise`). Not fma: glslang cannot mark the fma of
// GLSL as precise, and one that is not may be split by one driver and fused by another (lavapipe splits it).
#ifndef RELUME_ROW_PRODUCT_GLSL
#define RELUME_ROW_PRODUCT_GLSL

#include "../shared/bindings.h"
#include "fetch.glsl"
#include "lane_tree.glsl"
#include "local_radiosity.glsl"
#include "range.glsl"

layout(constant_id = kCodecConstant) const uint kCodec = kCodecF32;
layout(constant_id = kTileRowsConstant) const uint kTileRows = 1u;

layout(set = kBlockSet, binding = kTileOffsetsBinding, std430) readonly restrict buffer TileOffsets {
  uint tile_offsets[];
};
layout(set = kBlockSet, binding = kTileOffsetTexelsBinding) uniform usamplerBuffer tile_offset_texels;
layout(set = kBlockSet, binding = kColumnsBinding, std430) readonly restrict buffer Columns {
  uint columns[];
};
layout(set = kBlockSet, binding = kColumnTexelsBinding) uniform usamplerBuffer column_texels;
layout(set = kBlockSet, binding = kValuesBinding, std430) readonly restrict buffer Values {
  uint values[];
};
layout(set = kBlockSet, binding = kValueTexelsBinding) uniform usamplerBuffer value_texels;
layout(set = kBlockSet, binding = kRowScalesBinding, std430) readonly restrict buffer RowScales {
  float row_scales[];
};
layout(set = kBlockSet, binding = kRowScaleTexelsBinding) uniform samplerBuffer row_scale_texels;

uint tile_offset(uint tile) {
  if (kFetch == kFetchTexels) return texelFetch(tile_offset_texels, int(tile)).x;
  return tile_offsets[tile];
}

float row_scale(uint row) {
  if (kFetch == kFetchTexels) return texelFetch(row_scale_texels, int(row)).x;
  return row_scales[row];
}

uint column_word(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(column_texels, int(index)).x;
  return columns[index];
}

uint value_word(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(value_texels, int(index)).x;
  return values[index];
}

uint half_word(uint word, uint index) {
  return (index & 1u) == 0u ? word & 0xffffu : word >> 16;
}

uint column_of(uint entry) {
  return half_word(column_word(entry >> 1), entry);
}

/// Code number `index` of the block.
float code_at(uint index) {
  if (kCodec == kCodecUnorm16) return float(half_word(value_word(index >> 1), index));
  if (kCodec == kCodecSqrt8) {
    const uint root = (value_word(index >> 2) >> (8u * (index & 3u))) & 0xffu;
    return float(root * root);
  }
  return uintBitsToFloat(value_word(index));
}

uint first_entry(uint row) {
  return tile_offset(row / kTileRows);
}

uint end_entry(uint row) {
  return tile_offset(row / kTileRows + 1u);
}

/// Adds one entry of a row to the sum of its lane.
void add_entry(inout precise mat4x3 lane_sum, uint row, uint entry) {
  precise mat4x3 term =
      code_at(entry * kTileRows + row % kTileRows) * scaled_radiosities_of(column_of(entry));
  lane_sum = lane_sum + term;
}

/// What a row's sum is multiplied by.
float scale_of_sum(uint row) {
  precise float scale = row_scale(row);
  if (kCodec == kCodecUnorm16) scale = scale * (1.0 / 65535.0);
  if (kCodec == kCodecSqrt8) scale = scale * (1.0 / 65025.0);
  if (kHalfSenders != 0u) scale = scale * (1.0 / kSenderScale);
  return scale;
}

/// A row's sums times its scale.
mat4x3 scaled(uint row, mat4x3 sums) {
  precise mat4x3 product = sums * scale_of_sum(row);
  return product;
}

#endif
