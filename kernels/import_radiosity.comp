// SPDX-License-Identifier: MIT
//
// Copies the radiosity of the senders that a system imports to where its 16-bit columns find it.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "include/range.glsl"
#include "shared/bindings.h"

layout(set = kSolveSet, binding = kRadiosityInBinding, std430) readonly restrict buffer RadiosityIn {
  vec4 radiosity_in[];
};
layout(set = kSystemSet, binding = kImportsBinding, std430) readonly restrict buffer Imports {
  uint imports[];
};
layout(set = kSystemSet, binding = kLocalRadiosityBinding, std430) writeonly restrict buffer LocalRadiosity {
  vec4 local_radiosity[];
};

void main() {
  const uint import_index = gl_GlobalInvocationID.x;
  if (import_index < range.count) local_radiosity[import_index] = radiosity_in[imports[import_index]];
}
