// SPDX-License-Identifier: MIT
#ifndef RELUME_RADIOSITY_GLSL
#define RELUME_RADIOSITY_GLSL

#include "../shared/bindings.h"

layout(set = kSolveSet, binding = kRadiosityBinding, std430) restrict buffer Radiosity {
  vec4 radiosity[];
};

#endif
