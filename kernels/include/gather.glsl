// SPDX-License-Identifier: MIT
//
// What a gather makes of a row product: it is the irradiance of the receiver.
#ifndef RELUME_GATHER_GLSL
#define RELUME_GATHER_GLSL

#include "../shared/bindings.h"
#include "range.glsl"

layout(set = kSystemSet, binding = kIrradianceBinding, std430) writeonly restrict buffer Irradiance {
  vec4 irradiance_of_row[];
};

void finish_row(uint row, vec3 irradiance) {
  irradiance_of_row[range.block_row + row] = vec4(irradiance, 0.0);
}

#endif
