// SPDX-License-Identifier: MIT
//
// Of a lightmap kernel that shows irradiance: the mean over the lumels of a texel is their sum, one after the other,
// times 1 / number.
#ifndef RELUME_LIGHTMAP_IRRADIANCE_GLSL
#define RELUME_LIGHTMAP_IRRADIANCE_GLSL

#include "lightmap.glsl"

vec3 lumel_value(uint row) {
  precise vec3 value = irradiance[row].rgb;
  if (range.adds_direct != 0u) value = value + direct[row].rgb;
  return value;
}

vec3 texel_value(uint first, uint end) {
  precise vec3 sum = vec3(0.0);
  for (uint k = first; k < end; ++k) {
    sum = sum + lumel_value(lumels[k]);
    if (k + 1u == end) break;
  }
  if (end - first == 1u) return sum;
  precise vec3 mean = sum * (1.0 / float(end - first));
  return mean;
}

#endif
