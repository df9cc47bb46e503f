// SPDX-License-Identifier: MIT
//
// Several lightings of one model at once (SolverOptions::lightings). What each has of its own lies in planes of a
// buffer, one lighting after the other; only the local radiosity has those of a sender side by side, so that a row
// product reads the matrix once for all of them. Import, nodes and row kernels do all lightings in an invocation: they
// hold a column of a mat4x3 for each, of which those past kLightings are never read. Of the other kernels, a workgroup
// does the lighting that it has along z.
#ifndef RELUME_LIGHTINGS_GLSL
#define RELUME_LIGHTINGS_GLSL

#include "../shared/bindings.h"

layout(constant_id = kLightingsConstant) const uint kLightings = 1u;

/// The first element of a lighting, in a buffer of `length` elements.
uint first_of_lighting(uint lighting, int length) {
  return kLightings == 1u ? 0u : lighting * (uint(length) / kLightings);
}

#endif
