// SPDX-License-Identifier: MIT
//
// What a gather makes of a row product: it is the irradiance of the receiver.
#ifndef RELUME_GATHER_GLSL
#define RELUME_GATHER_GLSL

#include "../shared/bindings.h"
#include "lightings.glsl"
#include "range.glsl"

layout(set = kSystemSet, binding = kIrradianceBinding, std430) writeonly restrict buffer Irradiance {
  vec4 irradiance_of_row[];
};

void finish_row(uint row, mat4x3 irradiance) {
  for (uint lighting = 0u; lighting < kLightings; ++lighting) {
    irradiance_of_row[first_of_lighting(lighting, irradiance_of_row.length()) + range.block_row + row] =
        vec4(irradiance[lighting], 0.0);
  }
}

#endif
