// SPDX-License-Identifier: MIT
//
// Real orthonormal spherical harmonics in the order of core/probe_coefficients.h.
#ifndef RELUME_PROBE_HARMONICS_GLSL
#define RELUME_PROBE_HARMONICS_GLSL

#include "../shared/bindings.h"

/// mean_harmonics of core/probe_coefficients.h: of a mean direction, 1 long at most.
void mean_harmonics(vec3 d, out float y[kProbeHarmonics]) {
  const float squared = dot(d, d);
  const float second = 1.09254843 * sqrt(squared);  // sqrt(15 / 4 pi)
  y[0] = 0.282094792;                               // sqrt(1 / 4 pi)
  y[1] = 0.488602512 * d.y;                         // sqrt(3 / 4 pi)
  y[2] = 0.488602512 * d.z;
  y[3] = 0.488602512 * d.x;
  y[4] = second * d.x * d.y;
  y[5] = second * d.y * d.z;
  y[6] = second * (3.0 * d.z * d.z - squared) * 0.288675135;  // 1 / (2 sqrt(3))
  y[7] = second * d.x * d.z;
  y[8] = second * 0.5 * (d.x * d.x - d.y * d.y);
}

#endif
