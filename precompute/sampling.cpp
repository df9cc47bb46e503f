// SPDX-License-Identifier: MIT
#include "precompute/sampling.h"

namespace relume {
namespace {

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

}  // namespace

SobolPoints::SobolPoints(std::uint32_t count) : count_(count) {
  const std::size_t padded = (std::size_t{count} + kLanes - 1) / kLanes * kLanes;
  for (int d = 0; d < 4; ++d) {
    for (std::uint32_t index = 0; index < padded; ++index)
      reversed_[std::size_t(d)].push_back(reverse_bits(sobol(index, d)));
  }
}

SamplePoint SobolPoints::scrambled(std::uint32_t index, std::uint64_t seed) const {
  SamplePoint point;
  for (std::size_t d = 0; d < 4; ++d)
    point[d] = to_unit(reverse_bits(laine_karras(reversed_[d][index], scramble_key(d, seed))));
  return point;
}

Frame frame_about(const glm::vec3& n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

}  // namespace relume
