// SPDX-License-Identifier: MIT
//
// H of clusters [first, first + count): the mean of their elements by area.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/direct_light.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= range.count) return;
  do {
    const uint cluster = range.first + i;
    const uint first = tables[range.clusters + 2u * cluster];
    const uint end = first + tables[range.clusters + 2u * cluster + 1u];
    precise vec3 sum = vec3(0.0);
    for (uint element = first; element < end; ++element) {
      precise vec3 term = element_light[element].rgb * elements[element].weight;
      sum = sum + term;
    }
    cluster_light[cluster] = vec4(sum, 0.0);
    i += gl_NumWorkGroups.x * kWorkgroupSize;
  } while (i < range.count);
}
