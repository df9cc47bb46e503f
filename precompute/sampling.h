// SPDX-License-Identifier: MIT
//
// Owen-scrambled Sobol points in four dimensions and the warps that rays need. Nothing here calls the C
// library's trigonometry, whose last place differs between machines.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace relume {

/// 64 well-mixed bits from two numbers (the finaliser of splitmix64: G. Steele et al., Fast Splittable
/// Pseudorandom Number Generators, 2014).
constexpr std::uint64_t mix(std::uint64_t a, std::uint64_t b = 0) {
  std::uint64_t x = a + 0x9e3779b97f4a7c15ull * (b + 1);
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

using SamplePoint = std::array<float, 4>;  ///< each in [0, 1)

/// The first `count` points of the Sobol sequence (S. Joe, F. Kuo, Constructing Sobol Sequences with Better
/// Two-Dimensional Projections, 2008), scrambled anew for each seed by hashing (B. Burley, Practical
/// Hash-based Owen Scrambling, 2020).
class SobolPoints {
 public:
  explicit SobolPoints(std::uint32_t count);
  std::uint32_t count() const { return static_cast<std::uint32_t>(reversed_.size()); }
  /// Point `index` < count() of the sequence that belongs to `seed`.
  SamplePoint scrambled(std::uint32_t index, std::uint64_t seed) const;

 private:
  std::vector<std::array<std::uint32_t, 4>> reversed_;  ///< bit-reversed, as the scrambling wants them
};

/// Cosine-distributed direction about +Z: concentric map of the square to the disc (P. Shirley, K. Chiu,
/// 1997), lifted.
glm::vec3 cosine_direction(float u, float v);

/// Uniform barycentric (u, v) of a triangle from the unit square, without a square root (E. Heitz, A
/// Low-Distortion Map Between Triangle and Square, 2019).
inline glm::vec2 triangle_point(float u, float v) {
  if (v > u) {
    u *= 0.5f;
    v -= u;
  } else {
    v *= 0.5f;
    u -= v;
  }
  return {u, v};
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
