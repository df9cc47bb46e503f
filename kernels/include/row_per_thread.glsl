// SPDX-License-Identifier: MIT
//
// Body of a row kernel: one invocation does all eight lanes of a row. The kernel defines finish_row(row in
// the block, product).
#include "row_product.glsl"

mat4x3 row_product(uint row) {
  precise mat4x3 s0 = mat4x3(0.0), s1 = mat4x3(0.0), s2 = mat4x3(0.0), s3 = mat4x3(0.0);
  precise mat4x3 s4 = mat4x3(0.0), s5 = mat4x3(0.0), s6 = mat4x3(0.0), s7 = mat4x3(0.0);
  uint entry = first_entry(row);
  const uint end = end_entry(row);
  for (; entry + kLanes <= end; entry += kLanes) {
    add_entry(s0, row, entry);
    add_entry(s1, row, entry + 1u);
    add_entry(s2, row, entry + 2u);
    add_entry(s3, row, entry + 3u);
    add_entry(s4, row, entry + 4u);
    add_entry(s5, row, entry + 5u);
    add_entry(s6, row, entry + 6u);
    add_entry(s7, row, entry + 7u);
  }
  const uint rest = end - entry;
  if (rest > 0u) add_entry(s0, row, entry);
  if (rest > 1u) add_entry(s1, row, entry + 1u);
  if (rest > 2u) add_entry(s2, row, entry + 2u);
  if (rest > 3u) add_entry(s3, row, entry + 3u);
  if (rest > 4u) add_entry(s4, row, entry + 4u);
  if (rest > 5u) add_entry(s5, row, entry + 5u);
  if (rest > 6u) add_entry(s6, row, entry + 6u);
  return scaled(row, lane_tree(s0, s1, s2, s3, s4, s5, s6, s7));
}

void main() {
  if (gl_GlobalInvocationID.x >= range.count) return;
  const uint row = range.first_row + gl_GlobalInvocationID.x;
  finish_row(row, row_product(row));
}
