// SPDX-License-Identifier: MIT
//
// The one door to Embree: no other file includes it. Closest hits and occlusion against a fixed set of
// triangles, in robust mode, ISA pinned, hits at equal distance going to the lowest triangle. Triangles that
// are not opaque live apart in Embree's scene, so that only rays that meet them pay for them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/opacity.h"
#include "core/result.h"

namespace relume {

/// RayPacket::triangle of a ray that met nothing.
inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

/// Rays go in packets of this many; unused lanes have far < near. After closest_hits, `far` is the distance
/// of the hit.
inline constexpr int kPacketSize = 8;

/// A packet of rays in structure-of-arrays form, and after closest_hits what they met.
struct alignas(32) RayPacket {
  std::array<float, kPacketSize> origin_x, origin_y, origin_z, near;
  std::array<float, kPacketSize> direction_x, direction_y, direction_z, far;
  std::array<std::uint32_t, kPacketSize> triangle;  ///< kNoTriangle: met nothing
  std::array<float, kPacketSize> u, v;              ///< barycentric, as SurfacePiece
};

/// How rays meet a triangle that is not opaque (TriangleOpacity).
enum class AlphaTest {
  coin,   ///< it stops a ray with the probability of its opacity: light on its way
  solid,  ///< it stops whatever meets more than nothing of it: questions about the surfaces themselves
};

class RayCaster {
 public:
  /// Borrows nothing: all is copied. Fails with out_of_memory or bad_input (no finite triangle is not an
  /// error).
  static Result<RayCaster> create(std::span<const glm::vec3> positions,
                                  std::span<const std::array<std::uint32_t, 3>> triangles,
                                  const Opacity& opacity = {});
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;
  ~RayCaster();

  /// Every origin and direction must be finite. Directions need not be unit; distances are in multiples of
  /// them. Thread-safe.
  void closest_hits(RayPacket& packet, AlphaTest alpha = AlphaTest::coin) const;

  /// Bit l: whether lane l meets anything between near and far, by coin. Distances as in closest_hits.
  /// Thread-safe.
  std::uint32_t occluded(const RayPacket& packet) const;

  /// Whether anything lies between a and b, both of them included; AlphaTest::solid. Thread-safe.
  bool occluded(const glm::vec3& a, const glm::vec3& b) const;

  /// The share of light that gets from a to b: 0 behind anything opaque, else the product of 1 - opacity over
  /// all that it meets. Thread-safe.
  float transmittance(const glm::vec3& a, const glm::vec3& b) const;

  /// Library, version and instruction set, as recorded in the model.
  const std::string& description() const;

 private:
  struct Scene;
  explicit RayCaster(std::unique_ptr<Scene> scene);
  std::unique_ptr<Scene> scene_;
};

}  // namespace relume
