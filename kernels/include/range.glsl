// SPDX-License-Identifier: MIT
//
// What every kernel starts with: the workgroup and the push constants `range`.
#ifndef RELUME_RANGE_GLSL
#define RELUME_RANGE_GLSL

#include "../shared/limits.h"
#include "../shared/records.h"

layout(local_size_x = kWorkgroupSize) in;

layout(push_constant) uniform RangeConstants {
  Range range;
};

#endif
