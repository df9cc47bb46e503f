// SPDX-License-Identifier: MIT
//
// Body of a row kernel for tiles of eight: eight invocations of a subgroup, which must have eight or more, do a
// tile and meet by shuffles. The kernel defines finish_row(row in the block, product).
#include "meet_by_shuffles.glsl"
#include "tile_product.glsl"

void main() {
  const uint lane = lane_of_subgroup();
  const uint index = first_row_of_workgroup() + first_of_lanes();
  const uint tile = (range.first_row + index) / kTileOfRows;

  precise mat4x3 sums[kTileOfRows];
  for (uint row = 0u; row < kTileOfRows; ++row) sums[row] = mat4x3(0.0);
  if (index < range.count) add_tile_lane(sums, tile, lane);
  const mat4x3 sum = sums_of_lanes(sums, lane);
  if (index + lane >= range.count) return;
  const uint row = range.first_row + index + lane;
  finish_row(row, scaled(row, sum));
}
