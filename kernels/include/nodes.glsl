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

uint first_sender(uint lighting) {
  return first_of_lighting(lighting, radiosity.length()) + range.first_sender;
}

/// What lane `lane` of a node has of it: 0 without leaves. Radiosity comes from the storage buffer, because nodes of
/// several systems are written to it side by side, and validation takes a view of all of it for a hazard. The test comes last because lavapipe does the body of a
/// loop once more when it is first.
mat4x3 lane_of_node(uvec4 node, uint lane) {
  precise mat4x3 sum = mat4x3(0.0);
  uint i = lane;
  if (i >= node.y) return sum;
  do {
    const float share = share_of(node.z + i);
    for (uint lighting = 0u; lighting < kLightings; ++lighting) {
      precise vec3 term = share * radiosity[first_sender(lighting) + node.x + i].rgb;
      sum[lighting] = sum[lighting] + term;
    }
    i += kLanes;
  } while (i < node.y);
  return sum;
}

void write_node(uint index, mat4x3 mean) {
  for (uint lighting = 0u; lighting < kLightings; ++lighting)
    radiosity[first_sender(lighting) + range.block_row + index] = vec4(mean[lighting], 0.0);
}

#endif
