// SPDX-License-Identifier: MIT
#include "precompute/sampling.h"

#include <algorithm>
#include <numeric>

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

constexpr std::array<DirectionIntegers, 4> kDirectionIntegers{direction_integers(0), direction_integers(1),
                                                              direction_integers(2), direction_integers(3)};

constexpr std::uint32_t sobol(std::uint32_t index, int dimension) {
  std::uint32_t result = 0;
  for (std::uint32_t bit = 0; index != 0; index >>= 1, ++bit) {
    if ((index & 1u) != 0) result ^= kDirectionIntegers[std::size_t(dimension)][bit];
  }
  return result;
}

/// Position on the Morton curve of a point's first two coordinates. A scramble permutes the boxes of each
/// level of the curve, and with them the points: those that share a box go on sharing one.
constexpr std::uint64_t morton_code(std::uint32_t index) {
  const std::uint32_t x = sobol(index, 0), y = sobol(index, 1);
  std::uint64_t code = 0;
  for (std::uint32_t bit = 32; bit-- > 0;) code = code << 2 | (x >> bit & 1u) << 1 | (y >> bit & 1u);
  return code;
}

/// Indices of the sequence in the order in which points are kept.
std::vector<std::uint32_t> kept_order(std::uint32_t count, std::uint32_t grouped) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  if (grouped == 0) return order;
  std::vector<std::uint64_t> codes(count);
  std::transform(order.begin(), order.end(), codes.begin(), morton_code);
  const auto before = [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; };
  for (std::uint64_t first = 0, last = grouped; first < count; first = last, last *= 2) {
    std::sort(order.begin() + std::ptrdiff_t(first),
              order.begin() + std::ptrdiff_t(std::min<std::uint64_t>(last, count)), before);
  }
  return order;
}

}  // namespace

SobolPoints::SobolPoints(std::uint32_t count, std::uint32_t grouped) : count_(count) {
  std::vector<std::uint32_t> order = kept_order(count, grouped);
  while (order.size() % kLanes != 0) order.push_back(std::uint32_t(order.size()));
  for (int d = 0; d < 4; ++d) {
    for (const auto index : order) reversed_[std::size_t(d)].push_back(reverse_bits(sobol(index, d)));
  }
  numbers_ = std::move(order);
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
