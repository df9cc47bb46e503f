// SPDX-License-Identifier: MIT
//
// Colours from outside, made safe for a solve: NaN and what is below zero become zero.
#ifndef RELUME_BOUNDED_COLOR_GLSL
#define RELUME_BOUNDED_COLOR_GLSL

float bounded(float value, float largest) {
  return value > 0.0 ? min(value, largest) : 0.0;
}

vec3 bounded(vec3 color, float largest) {
  return vec3(bounded(color.r, largest), bounded(color.g, largest), bounded(color.b, largest));
}

#endif
