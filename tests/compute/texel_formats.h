// SPDX-License-Identifier: MIT
//
// Exact decoders of lightmap formats, written from the Khronos Data Format Specification 1.3, section 10.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/quantities.h"

namespace relume::test {

/// 5 bits of exponent (bias 15), then so many of mantissa.
inline double small_float(std::uint32_t code, int mantissa_bits) {
  const auto exponent = static_cast<int>(code >> mantissa_bits);
  const double mantissa = std::ldexp(code & ((1u << mantissa_bits) - 1u), -mantissa_bits);
  return exponent == 0 ? std::ldexp(mantissa, -14) : std::ldexp(1.0 + mantissa, exponent - 15);
}

inline double signed_half(std::uint16_t code) {
  return (code & 0x8000u) != 0 ? -small_float(code & 0x7fffu, 10) : small_float(code, 10);
}

inline Rgb decode_rgba16f(const std::array<std::uint16_t, 4>& codes) {
  return {signed_half(codes[0]), signed_half(codes[1]), signed_half(codes[2])};
}

inline Rgb decode_r11g11b10f(std::uint32_t word) {
  return {small_float(word & 0x7ffu, 6), small_float((word >> 11) & 0x7ffu, 6), small_float(word >> 22, 5)};
}

inline Rgb decode_rgb9e5(std::uint32_t word) {
  const double unit = std::ldexp(1.0, static_cast<int>(word >> 27) - 24);
  return unit * Rgb(word & 0x1ffu, (word >> 9) & 0x1ffu, (word >> 18) & 0x1ffu);
}

}  // namespace relume::test
