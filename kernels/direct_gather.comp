// SPDX-License-Identifier: MIT
//
// H of gather rows: that of their elements, sensors included.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/direct_light.glsl"

void main() {
  uint row = gl_GlobalInvocationID.x;
  if (row >= range.count) return;
  do {
    gather_light[row] = element_light[tables[range.gather_rows + row]];
    row += gl_NumWorkGroups.x * kWorkgroupSize;
  } while (row < range.count);
}
