// SPDX-License-Identifier: MIT
//
// Nodes of few parts by an invocation each, part by part.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/nodes.glsl"

void main() {
  const uint index = gl_GlobalInvocationID.x;
  if (index >= range.count) return;
  const uvec4 node = node_record(range.first_row + index);
  write_node(node, sums_of_parts(node, 0u, 1u));
}
