// SPDX-License-Identifier: MIT
#include "precompute/sampling.h"

namespace relume {
namespace {

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  return __builtin_bswap32(x);
}

/// Primitive polynomial and first direction integers of a Sobol dimension (Joe and Kuo's table).
struct Dimension {
  std::uint32_t degree;
  std::uint32_t coefficients;
  std::array<std::uint32_t, 3> initial;
};
constexpr std::array<Dimension, 3> kDimensions{{{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}}};

using DirectionIntegers = std::array<std::uint32_t, 32>;

constexpr DirectionIntegers direction_integers(int dimension) {
  DirectionIntegers v{};
  if (dimension == 0) {
    for (std::uint32_t bit = 0; bit < 32; ++bit) v[bit] = 1u << (31 - bit);
    return v;
  }
  const Dimension& d = kDimensions[std::size_t(dimension - 1)];
  for (std::uint32_t bit = 0; bit < 32; ++bit) {
    if (bit < d.degree) {
      v[bit] = d.initial[bit] << (31 - bit);
      continue;
    }
    v[bit] = v[bit - d.degree] ^ (v[bit - d.degree] >> d.degree);
    for (std::uint32_t k = 1; k < d.degree; ++k) {
      if (((d.coefficients >> (d.degree - 1 - k)) & 1u) != 0) v[bit] ^= v[bit - k];
    }
  }
  return v;
}

constexpr std::array<DirectionIntegers, 4> kDirections{direction_integers(0), direction_integers(1),
                                                       direction_integers(2), direction_integers(3)};

constexpr std::uint32_t sobol(std::uint32_t index, int dimension) {
  std::uint32_t result = 0;
  for (std::uint32_t bit = 0; index != 0; index >>= 1, ++bit) {
    if ((index & 1u) != 0) result ^= kDirections[std::size_t(dimension)][bit];
  }
  return result;
}

/// Permutes each bit by those below it: on reversed bits, an Owen scramble.
constexpr std::uint32_t laine_karras(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// sin and cos on [-pi/4, pi/4], Taylor to 1e-7.
float small_sin(float x) {
  const float y = x * x;
  return x *
         (1.0f + y * (-1.0f / 6.0f + y * (1.0f / 120.0f + y * (-1.0f / 5040.0f + y * (1.0f / 362880.0f)))));
}
float small_cos(float x) {
  const float y = x * x;
  return 1.0f + y * (-0.5f + y * (1.0f / 24.0f + y * (-1.0f / 720.0f + y * (1.0f / 40320.0f))));
}

}  // namespace

SobolPoints::SobolPoints(std::uint32_t count) : reversed_(count) {
  for (std::uint32_t index = 0; index < count; ++index) {
    for (int d = 0; d < 4; ++d) reversed_[index][std::size_t(d)] = reverse_bits(sobol(index, d));
  }
}

SamplePoint SobolPoints::scrambled(std::uint32_t index, std::uint64_t seed) const {
  SamplePoint point;
  for (std::uint32_t d = 0; d < 4; ++d) {
    const auto key = static_cast<std::uint32_t>((seed ^ (0xd1342543de82ef95ull * (d + 1))) >> 32) ^
                     static_cast<std::uint32_t>(seed * (2 * d + 1));
    const std::uint32_t bits = reverse_bits(laine_karras(reversed_[index][d], key));
    point[d] = static_cast<float>(bits >> 8) * 0x1p-24f;
  }
  return point;
}

glm::vec3 cosine_direction(float u, float v) {
  constexpr float kQuarterPi = 0.785398163f;
  const float a = 2.0f * u - 1.0f;
  const float b = 2.0f * v - 1.0f;
  float x = 0.0f, y = 0.0f, radius2 = 0.0f;
  if (std::abs(a) > std::abs(b)) {
    const float angle = kQuarterPi * (b / a);
    x = a * small_cos(angle);
    y = a * small_sin(angle);
    radius2 = a * a;
  } else if (b != 0.0f) {
    const float angle = kQuarterPi * (a / b);
    x = b * small_sin(angle);
    y = b * small_cos(angle);
    radius2 = b * b;
  }
  return {x, y, std::sqrt(std::max(0.0f, 1.0f - radius2))};
}

Frame frame_about(const glm::vec3& n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

}  // namespace relume
