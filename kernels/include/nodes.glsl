// SPDX-License-Identifier: MIT
//
// The nodes of a system's tree, or of the sky's: each is the mean of its parts by their shares, which are
// leaves, or nodes of a dispatch before (compute/node_tables.h).
#ifndef RELUME_NODES_GLSL
#define RELUME_NODES_GLSL

#include "fetch.glsl"
#include "lightings.glsl"
#include "range.glsl"

layout(set = kSystemSet, binding = kNodesBinding, std430) readonly restrict buffer Nodes {
  uvec4 nodes[];
};
layout(set = kSystemSet, binding = kNodePartsBinding, std430) readonly restrict buffer NodeParts {
  uvec2 node_parts[];
};
layout(set = kSystemSet, binding = kOwnRadiosityBinding, std430) restrict buffer OwnRadiosity {
  vec4 own_radiosity[];
};
layout(set = kSystemSet, binding = kNodeTexelsBinding) uniform usamplerBuffer node_texels;
layout(set = kSystemSet, binding = kNodePartTexelsBinding) uniform usamplerBuffer node_part_texels;
layout(set = kSystemSet, binding = kOwnRadiosityTexelsBinding) uniform samplerBuffer own_radiosity_texels;

uvec4 node_record(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(node_texels, int(index));
  return nodes[index];
}

uvec2 node_part(uint index) {
  if (kFetch == kFetchTexels) return texelFetch(node_part_texels, int(index)).xy;
  return node_parts[index];
}

uint first_sender(uint lighting) {
  return (kLightings == 1u ? 0u : lighting * range.block_row) + range.first_sender;
}

vec3 radiosity_of(uint lighting, uint sender) {
  const uint index = first_sender(lighting) + sender;
  if (kFetch == kFetchTexels) return texelFetch(own_radiosity_texels, int(index)).rgb;
  return own_radiosity[index].rgb;
}

/// The sum of every `stride`-th part of a node from `first` on.
mat4x3 sums_of_parts(uvec4 node, uint first, uint stride) {
  precise mat4x3 sum = mat4x3(0.0);
  for (uint i = first; i < node.y; i += stride) {
    const uvec2 part = node_part(node.x + i);
    for (uint lighting = 0u; lighting < kLightings; ++lighting) {
      precise vec3 term = uintBitsToFloat(part.y) * radiosity_of(lighting, part.x);
      sum[lighting] = sum[lighting] + term;
    }
    if (i + stride >= node.y) break;
  }
  return sum;
}

void write_node(uvec4 node, mat4x3 mean) {
  for (uint lighting = 0u; lighting < kLightings; ++lighting)
    own_radiosity[first_sender(lighting) + node.z] = vec4(mean[lighting], 0.0);
}

#endif
