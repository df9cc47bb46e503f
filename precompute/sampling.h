// SPDX-License-Identifier: MIT
//
// Owen-scrambled Sobol points in four dimensions and the warps that rays need. Nothing here calls the C
// library's trigonometry, whose last place differs between machines.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/mix.h"

namespace relume {

using SamplePoint = std::array<float, 4>;  ///< each in [0, 1)

/// Samples are made so many at a time: as many as go into a packet of rays.
inline constexpr std::size_t kLanes = 8;
using Lanes = std::array<float, kLanes>;

/// Consecutive points of a sequence, coordinate by coordinate.
struct alignas(32) SampleLanes {
  std::array<Lanes, 4> coordinate;
};

/// Permutes each bit of x by those below it: on reversed bits, an Owen scramble (B. Burley, Practical
/// Hash-based Owen Scrambling, 2020).
constexpr std::uint32_t laine_karras(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

/// The first `count` points of the Sobol sequence (S. Joe, F. Kuo, Constructing Sobol Sequences with Better
/// Two-Dimensional Projections, 2008), scrambled anew for each seed.
class SobolPoints {
 public:
  /// Where `grouped` > 0, points [0, grouped), [grouped, 2 grouped), [2 grouped, 4 grouped) ... keep to
  /// themselves but change places in each: neighbours get like first two coordinates, under every seed, so
  /// that the rays of a packet go nearly the same way. What was so many first points of the sequence still
  /// is.
  explicit SobolPoints(std::uint32_t count, std::uint32_t grouped = 0);
  std::uint32_t count() const { return count_; }
  /// Which points of the sequence `first` and the next are; `first` < count() is a multiple of kLanes. The
  /// ray of a point is the same ray whatever is grouped.
  std::span<const std::uint32_t, kLanes> numbers(std::uint32_t first) const {
    return std::span<const std::uint32_t, kLanes>(&numbers_[first], kLanes);
  }
  /// The same of so many, as far as there are points.
  std::span<const std::uint32_t> numbers(std::uint32_t first, std::uint32_t count) const {
    return std::span(numbers_).first(count_).subspan(first, std::min(count, count_ - first));
  }
  std::uint32_t number(std::uint32_t point) const { return numbers_[point]; }
  /// Point `index` < count() of the sequence that belongs to `seed`.
  SamplePoint scrambled(std::uint32_t index, std::uint64_t seed) const;
  /// Points first, first + 1 ... of the same sequence; `first` < count() is a multiple of kLanes. What lies
  /// beyond count() goes on with the sequence.
  void scrambled(std::uint32_t first, std::uint64_t seed, SampleLanes& lanes) const {
    for (std::size_t d = 0; d < 4; ++d) {
      const std::uint32_t key = scramble_key(d, seed);
      const std::uint32_t* reversed = &reversed_[d][first];
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        lanes.coordinate[d][lane] = to_unit(reverse_bits(laine_karras(reversed[lane], key)));
    }
  }
  /// The same of any points.
  void scrambled(const std::array<std::uint32_t, kLanes>& points, std::uint64_t seed,
                 SampleLanes& lanes) const {
    for (std::size_t d = 0; d < 4; ++d) {
      const std::uint32_t key = scramble_key(d, seed);
      const std::uint32_t* reversed = reversed_[d].data();
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        lanes.coordinate[d][lane] = to_unit(reverse_bits(laine_karras(reversed[points[lane]], key)));
    }
  }

 private:
  static constexpr std::uint32_t scramble_key(std::size_t dimension, std::uint64_t seed) {
    return static_cast<std::uint32_t>((seed ^ (0xd1342543de82ef95ull * (dimension + 1))) >> 32) ^
           static_cast<std::uint32_t>(seed * (2 * dimension + 1));
  }
  /// By way of a signed number, which all vector units convert.
  static constexpr float to_unit(std::uint32_t bits) {
    return static_cast<float>(static_cast<std::int32_t>(bits >> 8)) * 0x1p-24f;
  }
  std::uint32_t count_;
  std::vector<std::uint32_t> numbers_;                  ///< of the points as they are kept
  std::array<std::vector<std::uint32_t>, 4> reversed_;  ///< bit-reversed, as the scrambling wants them
};

/// sin and cos on [-pi/4, pi/4], Taylor to 1e-7.
inline float small_sin(float x) {
  const float y = x * x;
  return x *
         (1.0f + y * (-1.0f / 6.0f + y * (1.0f / 120.0f + y * (-1.0f / 5040.0f + y * (1.0f / 362880.0f)))));
}
inline float small_cos(float x) {
  const float y = x * x;
  return 1.0f + y * (-0.5f + y * (1.0f / 24.0f + y * (-1.0f / 720.0f + y * (1.0f / 40320.0f))));
}

/// Cosine-distributed direction about +Z: concentric map of the square to the disc (P. Shirley, K. Chiu,
/// 1997), lifted. Without branches, so that lanes go together.
inline glm::vec3 cosine_direction(float u, float v) {
  constexpr float kQuarterPi = 0.785398163f;
  const float a = 2.0f * u - 1.0f;
  const float b = 2.0f * v - 1.0f;
  const bool along_u = std::abs(a) > std::abs(b);
  const float radius = along_u ? a : b;
  const float angle = kQuarterPi * ((along_u ? b : a) / (radius == 0.0f ? 1.0f : radius));
  const float near_axis = radius * small_cos(angle), across = radius * small_sin(angle);
  const float rest = 1.0f - radius * radius;
  return {along_u ? near_axis : across, along_u ? across : near_axis, std::sqrt(rest > 0.0f ? rest : 0.0f)};
}

/// Uniform barycentric (u, v) of a triangle from the unit square, without a square root (E. Heitz, A
/// Low-Distortion Map Between Triangle and Square, 2019).
inline glm::vec2 triangle_point(float u, float v) {
  const float half_u = 0.5f * u, half_v = 0.5f * v;
  return {v > u ? half_u : u - half_v, v > u ? v - half_u : half_v};
}

/// Orthonormal frame about a unit normal (T. Duff et al., Building an Orthonormal Basis, Revisited, 2017).
struct Frame {
  glm::vec3 tangent, bitangent, normal;
  glm::vec3 to_world(const glm::vec3& local) const {
    return tangent * local.x + bitangent * local.y + normal * local.z;
  }
};
Frame frame_about(const glm::vec3& normal);

}  // namespace relume
