// SPDX-License-Identifier: MIT
//
// H of gather rows: that of their elements, sensors included.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/direct_light.glsl"

void main() {
  const uint step_size = gl_NumWorkGroups.x * kWorkgroupSize;
  for (uint row = gl_GlobalInvocationID.x; row < range.count; row += step_size)
    gather_light[row] = element_light[tables[range.gather_rows + row]];
}
