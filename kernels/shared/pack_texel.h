// SPDX-License-Identifier: MIT
//
// Colours in the small floating-point formats of lightmaps, rounded to nearest, ties to even. Integers only:
// so GLSL and C++ give the same bits on every device, whatever its rounding mode and denormals (imageStore
// may truncate).
//
// Every channel is given as the bits of a 32-bit float. NaN and numbers below zero (but for pack_signed_half)
// become zero, numbers above the largest of the format become the largest.
//
//   rgba16f     sign, 5 bits of exponent, 10 of mantissa; largest 65504
//   r11g11b10f  5 bits of exponent, 6, 6, 5 of mantissa; largest 65024, 65024, 64512; red in the low bits
//               (Khronos Data Format Specification 1.3, sections 10.2 to 10.4)
//   rgb9e5      9 bits each and 5 of a shared exponent (section 10.5); largest 65408; red in the low bits
#ifndef RELUME_KERNELS_PACK_TEXEL_H
#define RELUME_KERNELS_PACK_TEXEL_H

#include "glsl_types.h"

RELUME_SHARED_BEGIN

const uint kInfinityBits = 0x7f800000u;
const uint kHalfOne = 0x3c00u;
const uint kSmallestNormalHalf = 0x0400u;     // 2^-14
const uint kLargestRgb9e5Bits = 0x477f8000u;  // 65408

/// value / 2^shift, 1 <= shift <= 31.
RELUME_SHARED_FUNCTION uint shift_to_nearest_even(uint value, uint shift) {
  const uint odd = (value >> shift) & 1u;
  return (value + (1u << (shift - 1u)) - 1u + odd) >> shift;
}

/// An unsigned float of 5 bits of exponent and so many of mantissa (at most 10).
RELUME_SHARED_FUNCTION uint pack_small_float(uint bits, uint mantissa_bits) {
  if (bits > kInfinityBits) return 0u;
  const uint dropped = 23u - mantissa_bits;
  const uint largest = (31u << mantissa_bits) - 1u;
  if (bits >= (largest << dropped) + (112u << 23u)) return largest;
  const uint exponent = bits >> 23u;
  if (exponent >= 113u) return shift_to_nearest_even(bits - (112u << 23u), dropped);
  const uint shift = dropped + 113u - exponent;
  if (shift > 24u) return 0u;
  return shift_to_nearest_even((bits & 0x7fffffu) | 0x800000u, shift);
}

RELUME_SHARED_FUNCTION uint pack_half(uint bits) {
  return pack_small_float(bits, 10u);
}

/// NaN becomes zero here too; what lies below the lowest becomes the lowest.
RELUME_SHARED_FUNCTION uint pack_signed_half(uint bits) {
  return pack_half(bits & 0x7fffffffu) | ((bits >> 16u) & 0x8000u);
}

RELUME_SHARED_FUNCTION uint pack_r11g11b10f(uint red, uint green, uint blue) {
  return pack_small_float(red, 6u) | (pack_small_float(green, 6u) << 11u) |
         (pack_small_float(blue, 5u) << 22u);
}

RELUME_SHARED_FUNCTION uint clamp_for_rgb9e5(uint bits) {
  if (bits > kInfinityBits) return 0u;
  return bits < kLargestRgb9e5Bits ? bits : kLargestRgb9e5Bits;
}

/// A channel in units of 2^(exponent - 24). The exponent is at least that of the channel.
RELUME_SHARED_FUNCTION uint rgb9e5_mantissa(uint bits, uint exponent) {
  const uint shift = exponent + 126u - (bits >> 23u);
  if (shift > 24u) return 0u;
  return shift_to_nearest_even((bits & 0x7fffffu) | 0x800000u, shift);
}

RELUME_SHARED_FUNCTION uint pack_rgb9e5(uint red, uint green, uint blue) {
  const uint r = clamp_for_rgb9e5(red);
  const uint g = clamp_for_rgb9e5(green);
  const uint b = clamp_for_rgb9e5(blue);
  const uint red_green = r > g ? r : g;
  const uint largest = red_green > b ? red_green : b;  // non-negative floats order as their bits do
  uint exponent = (largest >> 23u) > 111u ? (largest >> 23u) - 111u : 0u;
  if (rgb9e5_mantissa(largest, exponent) == 512u) exponent = exponent + 1u;
  return rgb9e5_mantissa(r, exponent) | (rgb9e5_mantissa(g, exponent) << 9u) |
         (rgb9e5_mantissa(b, exponent) << 18u) | (exponent << 27u);
}

RELUME_SHARED_END

#endif
