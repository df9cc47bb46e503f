// SPDX-License-Identifier: MIT
//
// Body of a row kernel for tiles of eight: eight invocations of a subgroup, which must have eight or more, do a
// tile. They meet by shuffles: in each of three steps an invocation keeps the rows that have its own bit and adds
// what its partner has of them. That is the tree of include/lane_tree.glsl, because a + b = b + a to the
// bit; in the end each has one row. The kernel defines finish_row(row in the block, product).
#include "tile_product.glsl"

/// Rows of the half that `upper` names, over two lanes; partners differ in `bit` of their number.
vec3 met(vec3 lower_row, vec3 upper_row, bool upper, uint bit) {
  const vec3 kept = upper ? upper_row : lower_row;
  const vec3 given = upper ? lower_row : upper_row;
  precise vec3 sum = kept + subgroupShuffle(given, gl_SubgroupInvocationID ^ bit);
  return sum;
}

/// The finished sum of row `lane` of the tile.
vec3 row_of_lane(vec3 sums[kTileOfRows], uint lane) {
  const bool bit_2 = (lane & 4u) != 0u, bit_1 = (lane & 2u) != 0u, bit_0 = (lane & 1u) != 0u;
  const vec3 s0 = met(sums[0], sums[4], bit_2, 4u), s1 = met(sums[1], sums[5], bit_2, 4u);
  const vec3 s2 = met(sums[2], sums[6], bit_2, 4u), s3 = met(sums[3], sums[7], bit_2, 4u);
  const vec3 t0 = met(s0, s2, bit_1, 2u), t1 = met(s1, s3, bit_1, 2u);
  return met(t0, t1, bit_0, 1u);
}

void main() {
  const uint tile_of_group =
      gl_SubgroupID * (gl_SubgroupSize / kLanes) + gl_SubgroupInvocationID / kLanes;
  const uint lane = gl_SubgroupInvocationID & (kLanes - 1u);
  const uint index = first_row_of_workgroup() + tile_of_group * kTileOfRows;
  const uint tile = (range.first_row + index) / kTileOfRows;

  precise vec3 sums[kTileOfRows];
  for (uint row = 0u; row < kTileOfRows; ++row) sums[row] = vec3(0.0);
  if (index < range.count) add_tile_lane(sums, tile, lane);
  const vec3 sum = row_of_lane(sums, lane);
  if (index + lane >= range.count) return;
  const uint row = range.first_row + index + lane;
  finish_row(row, scaled(row, sum));
}
