// SPDX-License-Identifier: MIT
//
// What every kernel starts with: the workgroup and the push constants `range`.
//
// Loops are shaped for lavapipe 22.3, which does the body once more than it needs to when the test comes first, and
// gives wrong sums when it comes last and invocations of a subgroup leave at different turns: loops of equally many
// turns test last, others first and once more, with a break, at the end.
#ifndef RELUME_RANGE_GLSL
#define RELUME_RANGE_GLSL

#include "../shared/limits.h"
#include "../shared/records.h"

layout(local_size_x = kWorkgroupSize) in;

layout(push_constant) uniform RangeConstants {
  Range range;
};

#endif
