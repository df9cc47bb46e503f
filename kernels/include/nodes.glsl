// SPDX-License-Identifier: MIT
//
// The nodes of a system's tree, or of the sky's: each is the mean of its leaves by their shares, summed by
// eight invocations like a row (include/row_product.glsl) of share x radiosity.
#ifndef RELUME_NODES_GLSL
#define RELUME_NODES_GLSL

#include "fetch.glsl"
#include "lightings.glsl"
#include "radiosity.glsl"
#include "range.glsl"

layout(set = kSystemSet, binding = kNodesBinding, std430) readonly restrict buffer Nodes {
  uvec4 nodes[];
};
layout(set = kSystemSet, binding = kNodeSharesBinding, std430) readonly restrict buffer Shares {
  float shares[];
};
layout(set = kSystemSet, binding = kNodeTexelsBinding) uniform usamplerBuffer node_texels;
layout(set = kSystemSet, binding = kNodeShareTexelsBinding) uniform samplerBuffer share_texels;

uvec4 node_record(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(node_texels, int(index));
  return nodes[index];
}

float share_of(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(share_texels, int(index)).x;
  return shares[index];
}

/// Of the lighting of the workgroup.
uint own_first_sender() {
  return first_of_lighting(gl_WorkGroupID.z, radiosity.length()) + range.first_sender;
}

/// What lane `lane` of a node has of it: 0 without leaves. Radiosity comes from the storage buffer, because nodes of
/// several systems are written to it side by side, and validation takes a view of all of it for a hazard. The test comes last because lavapipe does the body of a
/// loop once more when it is first.
vec3 lane_of_node(uvec4 node, uint lane) {
  precise vec3 sum = vec3(0.0);
  uint i = lane;
  if (i >= node.y) return sum;
  do {
    precise vec3 term = share_of(node.z + i) * radiosity[own_first_sender() + node.x + i].rgb;
    sum = sum + term;
    i += kLanes;
  } while (i < node.y);
  return sum;
}

void write_node(uint index, vec3 mean) {
  radiosity[own_first_sender() + range.block_row + index] = vec4(mean, 0.0);
}

#endif
