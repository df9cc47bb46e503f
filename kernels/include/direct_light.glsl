// SPDX-License-Identifier: MIT
//
// What the kernels of direct light share: the workgroup, push constants and most buffers.
#ifndef RELUME_DIRECT_LIGHT_GLSL
#define RELUME_DIRECT_LIGHT_GLSL

#include "../shared/direct_light.h"
#include "../shared/limits.h"

layout(local_size_x = kWorkgroupSize) in;

layout(push_constant) uniform RangeConstants {
  DirectLightRange range;
};

layout(set = 0, binding = kPiecesBinding, std430) readonly restrict buffer Pieces {
  LightPiece pieces[];
};
layout(set = 0, binding = kPatchesBinding, std430) readonly restrict buffer Patches {
  uint patches[];
};
layout(set = 0, binding = kElementsBinding, std430) readonly restrict buffer Elements {
  LightElement elements[];
};
layout(set = 0, binding = kTablesBinding, std430) readonly restrict buffer Tables {
  uint tables[];  // from 0 on two per block: first element, number of elements; then as DirectLightRange says
};
layout(set = 0, binding = kLightsBinding, std430) readonly restrict buffer Lights {
  LightRecord lights[];
};
layout(set = 0, binding = kWorkBinding, std430) readonly restrict buffer Work {
  uint work[];
};
layout(set = 0, binding = kSharesBinding, std430) restrict buffer Shares {
  float shares[];
};
layout(set = 0, binding = kElementLightBinding, std430) restrict buffer ElementLight {
  vec4 element_light[];
};
layout(set = 0, binding = kClusterLightBinding, std430) writeonly restrict buffer ClusterLight {
  vec4 cluster_light[];
};
layout(set = 0, binding = kGatherLightBinding, std430) writeonly restrict buffer GatherLight {
  vec4 gather_light[];
};
layout(set = 0, binding = kVisibilityBinding, std430) readonly restrict buffer Visibility {
  float visibility[];
};

#endif
