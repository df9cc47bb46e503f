// SPDX-License-Identifier: MIT
//
// Body of a row kernel for tiles of eight: eight invocations do a tile and meet in shared memory, so that it is right at
// any subgroup width. The kernel defines finish_row(row in the block, product).
#include "tile_product.glsl"

shared vec4 lane_sums[kTileOfRows * kWorkgroupSize];  // row of the tile, then invocation

vec3 lane_sum_of(uint row, uint invocation) {
  return lane_sums[row * kWorkgroupSize + invocation].xyz;
}

/// `first`: the invocation that has lane 0.
vec3 sum_of_lanes(uint row, uint first) {
  return lane_tree(lane_sum_of(row, first), lane_sum_of(row, first + 1u), lane_sum_of(row, first + 2u),
                   lane_sum_of(row, first + 3u), lane_sum_of(row, first + 4u), lane_sum_of(row, first + 5u),
                   lane_sum_of(row, first + 6u), lane_sum_of(row, first + 7u));
}

void main() {
  const uint first = gl_LocalInvocationIndex & ~(kLanes - 1u);
  const uint lane = gl_LocalInvocationIndex - first;
  const uint index = first_row_of_workgroup() + first;
  const uint tile = (range.first_row + index) / kTileOfRows;

  precise mat4x3 sums[kTileOfRows];
  for (uint row = 0u; row < kTileOfRows; ++row) sums[row] = mat4x3(0.0);
  if (index < range.count) add_tile_lane(sums, tile, lane);
  mat4x3 product = mat4x3(0.0);
  for (uint lighting = 0u; lighting < kLightings; ++lighting) {
    if (lighting > 0u) barrier();
    for (uint row = 0u; row < kTileOfRows; ++row) {
      lane_sums[row * kWorkgroupSize + gl_LocalInvocationIndex] = vec4(sums[row][lighting], 0.0);
    }
    memoryBarrierShared();
    barrier();
    product[lighting] = sum_of_lanes(lane, first);
  }
  if (index + lane >= range.count) return;
  const uint row = range.first_row + index + lane;
  finish_row(row, scaled(row, product));
}
