// SPDX-License-Identifier: MIT
//
// The nodes of a system's tree, or of the sky's: each is the mean of its parts by their shares, which are
// leaves, or nodes of a dispatch before (compute/node_tables.h).
#ifndef RELUME_NODES_GLSL
#define RELUME_NODES_GLSL

#include "fetch.glsl"
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

vec3 radiosity_of_sender(uint sender) {
  const uint index = range.first_sender + sender;
  if (kFetch == kFetchTexels) return texelFetch(own_radiosity_texels, int(index)).rgb;
  return own_radiosity[index].rgb;
}

/// The sum of every `stride`-th part of a node from `first` on.
vec3 sum_of_parts(uvec4 node, uint first, uint stride) {
  precise vec3 sum = vec3(0.0);
  for (uint i = first; i < node.y; i += stride) {
    const uvec2 part = node_part(node.x + i);
    precise vec3 term = uintBitsToFloat(part.y) * radiosity_of_sender(part.x);
    sum = sum + term;
    if (i + stride >= node.y) break;
  }
  return sum;
}

void write_node(uvec4 node, vec3 mean) {
  own_radiosity[range.first_sender + node.z] = vec4(mean, 0.0);
}

#endif
