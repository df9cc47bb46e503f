// SPDX-License-Identifier: MIT
//
// Mean directions m, no longer than 1, as three signed 10-bit integers q in 32 bits: m = q / 511, x in the
// lowest bits, then y, then z; the two highest bits are zero.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace relume {

inline constexpr int kPackedDirectionMax = 511;

/// The three integers of a code.
inline glm::ivec3 packed_integers(std::uint32_t code) {
  const auto component = [code](int shift) {
    const auto bits = static_cast<int>(code >> shift & 0x3ffu);
    return bits < 512 ? bits : bits - 1024;
  };
  return {component(0), component(10), component(20)};
}

inline glm::dvec3 unpack_direction(std::uint32_t code) {
  return glm::dvec3(packed_integers(code)) / double(kPackedDirectionMax);
}

/// Whether it stands for a direction no longer than 1.
inline bool is_packed_direction(std::uint32_t code) {
  const glm::ivec3 q = packed_integers(code);
  return code >> 30 == 0 && q.x * q.x + q.y * q.y + q.z * q.z <= kPackedDirectionMax * kPackedDirectionMax;
}

/// The nearest code or, where that is longer than 1, one with components nearer to 0: each is off by less
/// than 1 / 511. Directions longer than 1 become 1 long.
inline std::uint32_t pack_direction(const glm::dvec3& direction) {
  const double length = glm::length(direction);
  const glm::dvec3 exact = direction * (kPackedDirectionMax / (length > 1.0 ? length : 1.0));
  glm::ivec3 q(std::lround(exact.x), std::lround(exact.y), std::lround(exact.z));
  while (q.x * q.x + q.y * q.y + q.z * q.z > kPackedDirectionMax * kPackedDirectionMax) {
    int most = 0;  // the component that was rounded up most
    for (int axis = 1; axis < 3; ++axis) {
      if (std::abs(q[axis]) - std::abs(exact[axis]) > std::abs(q[most]) - std::abs(exact[most])) most = axis;
    }
    q[most] -= q[most] > 0 ? 1 : -1;
  }
  const auto bits = [](int component) { return static_cast<std::uint32_t>(component) & 0x3ffu; };
  return bits(q.x) | bits(q.y) << 10 | bits(q.z) << 20;
}

}  // namespace relume
