// SPDX-License-Identifier: MIT
//
// The fixed tree in which the sums of eight lanes meet.
#ifndef RELUME_LANE_TREE_GLSL
#define RELUME_LANE_TREE_GLSL

vec3 lane_tree(vec3 s0, vec3 s1, vec3 s2, vec3 s3, vec3 s4, vec3 s5, vec3 s6, vec3 s7) {
  precise vec3 sum = ((s0 + s4) + (s2 + s6)) + ((s1 + s5) + (s3 + s7));
  return sum;
}

/// The same of every lighting.
mat4x3 lane_tree(mat4x3 s0, mat4x3 s1, mat4x3 s2, mat4x3 s3, mat4x3 s4, mat4x3 s5, mat4x3 s6, mat4x3 s7) {
  precise mat4x3 sum = ((s0 + s4) + (s2 + s6)) + ((s1 + s5) + (s3 + s7));
  return sum;
}

#endif
