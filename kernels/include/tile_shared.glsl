// SPDX-License-Identifier: MIT
//
// Body of a row kernel for tiles of eight: eight invocations do a tile and meet in shared memory, so that it is right at
// any subgroup width. The kernel defines finish_row(row in the block, product).
#include "tile_product.glsl"

shared vec4 lane_sums[kTileOfRows * kWorkgroupSize];  // row of the tile, then invocation

vec3 lane_sum_of(uint row, uint invocation) {
  return lane_sums[row * kWorkgroupSize + invocation].xyz;
}

void main() {
  const uint first = gl_LocalInvocationIndex & ~(kLanes - 1u);
  const uint lane = gl_LocalInvocationIndex - first;
  const uint index = first_row_of_workgroup() + first;
  const uint tile = (range.first_row + index) / kTileOfRows;

  precise vec3 sums[kTileOfRows];
  for (uint row = 0u; row < kTileOfRows; ++row) sums[row] = vec3(0.0);
  if (index < range.count) add_tile_lane(sums, tile, lane);
  for (uint row = 0u; row < kTileOfRows; ++row) {
    lane_sums[row * kWorkgroupSize + gl_LocalInvocationIndex] = vec4(sums[row], 0.0);
  }
  memoryBarrierShared();
  barrier();
  if (index + lane >= range.count) return;
  const uint row = range.first_row + index + lane;
  finish_row(row, row_result(row, lane_sum_of(lane, first), lane_sum_of(lane, first + 1u),
                             lane_sum_of(lane, first + 2u), lane_sum_of(lane, first + 3u),
                             lane_sum_of(lane, first + 4u), lane_sum_of(lane, first + 5u),
                             lane_sum_of(lane, first + 6u), lane_sum_of(lane, first + 7u)));
}
