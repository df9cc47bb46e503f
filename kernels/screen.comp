// SPDX-License-Identifier: MIT
//
// Reduces an image to the clusters that show it: each gets the weighted mean of its samples, times a factor. A
// workgroup does a cluster; its sums meet in two levels of the tree of include/lane_tree.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/bounded_color.glsl"
#include "include/lane_tree.glsl"
#include "shared/limits.h"
#include "shared/materials.h"

layout(local_size_x = kWorkgroupSize) in;

layout(push_constant) uniform Constants {
  ScreenConstants constants;
};

layout(set = 0, binding = kScreenClustersBinding, std430) readonly restrict buffer Clusters {
  uvec4 clusters[];
};
layout(set = 0, binding = kScreenSamplesBinding, std430) readonly restrict buffer Samples {
  float samples[];
};
layout(set = 0, binding = kScreenAlbedoBinding, std430) writeonly restrict buffer Albedo {
  vec4 albedo[];
};
layout(set = 0, binding = kScreenExitanceBinding, std430) writeonly restrict buffer Exitance {
  vec4 exitance[];
};
layout(set = 0, binding = kScreenImageBinding) uniform sampler2D image;

shared vec4 sums[kWorkgroupSize];

vec3 tree_of_eight(uint first) {
  return lane_tree(sums[first].xyz, sums[first + 1u].xyz, sums[first + 2u].xyz, sums[first + 3u].xyz,
                   sums[first + 4u].xyz, sums[first + 5u].xyz, sums[first + 6u].xyz, sums[first + 7u].xyz);
}

vec3 own_sum(uvec4 record) {
  precise vec3 sum = vec3(0.0);
  for (uint i = record.y + gl_LocalInvocationIndex; i < record.y + record.z; i += kWorkgroupSize) {
    const vec2 at = vec2(samples[3u * i], samples[3u * i + 1u]);
    precise vec3 term = samples[3u * i + 2u] * textureLod(image, at, 0.0).rgb;
    sum = sum + term;
  }
  return sum;
}

/// Of all invocations of the workgroup, in the first.
vec3 group_sum(vec3 own) {
  sums[gl_LocalInvocationIndex] = vec4(own, 0.0);
  memoryBarrierShared();
  barrier();
  vec3 eight = vec3(0.0);
  if (gl_LocalInvocationIndex < kLanes) eight = tree_of_eight(kLanes * gl_LocalInvocationIndex);
  barrier();
  if (gl_LocalInvocationIndex < kLanes) sums[gl_LocalInvocationIndex] = vec4(eight, 0.0);
  memoryBarrierShared();
  barrier();
  return tree_of_eight(0u);
}

void store(uint cluster, vec3 mean) {
  const vec3 color = mean * constants.factor.rgb;
  if (constants.sets_albedo != 0u) {
    albedo[cluster] = vec4(bounded(color, constants.max_albedo), 0.0);
  } else {
    exitance[cluster] = vec4(bounded(color, kLargestExitance), 0.0);
  }
}

void main() {
  const uvec4 record = clusters[gl_WorkGroupID.x];
  const vec3 mean = group_sum(own_sum(record));
  if (gl_LocalInvocationIndex == 0u) store(record.x, mean);
}
