// SPDX-License-Identifier: MIT
//
// The one door to Embree: no other file includes it. Closest hits and occlusion against a fixed set of
// triangles, in robust mode, ISA pinned.
//
// Hits at equal distance go to the lowest triangle among those that they lie inside of, else to the lowest of
// all; never to the order in which Embree's tree is walked, so that other geometry elsewhere changes nothing.
// They are found where they can be: at the edges of triangles, and on triangles that lie on others in one
// plane (overlap_in_plane.h) or are very thin, which are marked when the scene is made. A ray that meets one
// of those is traced once more around the hit; all others need no filter, which would be called for every
// triangle that a ray meets. Where the edge of one triangle touches the inside of another, as where a wall
// stands on a floor, the other one has the hit, asked again or not. Not found is where two cross: rays within
// rounding of it, one in ten millions, may go to either, unless whoever knows the place asks for it (settle).
// Embree's tree, and with it the answer, is the same for any number of threads.
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

/// A packet of rays in structure-of-arrays form, and after closest_hits what they met. Laid out as Embree has
/// it, so that nothing is copied; members without a comment are Embree's own.
struct alignas(32) RayPacket {
  using Floats = std::array<float, kPacketSize>;
  using Numbers = std::array<std::uint32_t, kPacketSize>;
  Floats origin_x, origin_y, origin_z, near;
  Floats direction_x, direction_y, direction_z;
  Floats time{};
  Floats far;
  Numbers mask{~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u};
  Numbers id{}, flags{};
  Floats normal_x, normal_y, normal_z;
  Floats u, v;       ///< barycentric, as SurfacePiece
  Numbers triangle;  ///< kNoTriangle: met nothing
  Numbers geometry, instance;
};

/// What the rays of a packet have in common. It changes how fast they are traced, not what they meet.
enum class RaySpread { wide, narrow /**< nearly one origin and one direction */ };

/// How rays meet a triangle that is not opaque (TriangleOpacity).
enum class AlphaTest {
  coin,   ///< it stops a ray with the probability of its opacity: light on its way
  solid,  ///< it stops whatever meets more than nothing of it: questions about the surfaces themselves
};

/// Of a triangle: whether it ties with others has to be found out.
inline constexpr std::uint8_t kUnknownTies = 0xff;

class RayCaster {
 public:
  /// Borrows nothing: all is copied. Fails with out_of_memory or bad_input (no finite triangle is not an
  /// error). `known_ties`: empty, or per triangle what ties() says of it, or kUnknownTies.
  static Result<RayCaster> create(std::span<const glm::vec3> positions,
                                  std::span<const std::array<std::uint32_t, 3>> triangles,
                                  const Opacity& opacity = {}, std::span<const std::uint8_t> known_ties = {});
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;
  ~RayCaster();

  /// Every origin and direction must be finite. Directions need not be unit; distances are in multiples of
  /// them. Thread-safe.
  void closest_hits(RayPacket& packet, RaySpread spread = RaySpread::wide,
                    AlphaTest alpha = AlphaTest::coin) const;

  /// Bit l: whether lane l meets anything between near and far. Distances as in closest_hits; `far` is used
  /// up. Thread-safe.
  std::uint32_t occluded(RayPacket& packet, AlphaTest alpha = AlphaTest::coin) const;

  /// Whether anything lies between a and b, both of them included; AlphaTest::solid. Thread-safe.
  bool occluded(const glm::vec3& a, const glm::vec3& b) const;

  /// How far one gets from a point along a unit direction, at most `most`; AlphaTest::solid. Thread-safe.
  float free_way(const glm::vec3& from, const glm::vec3& direction, float most) const;

  /// The share of light that gets from a to b: 0 behind anything opaque, else the product of 1 - opacity over
  /// all that it meets. Thread-safe.
  float transmittance(const glm::vec3& a, const glm::vec3& b) const;

  /// Of lanes that closest_hits has answered, by coin: gives them to the triangle that takes a hit, among
  /// those as far away up to rounding. For hits where surfaces are known to cross. Thread-safe.
  void settle(RayPacket& packet, std::uint32_t lanes) const;

  /// Per triangle, not 0: closest_hits settles all hits on it, for it lies on another in one plane or is very
  /// thin. Empty where none is.
  const std::vector<std::uint8_t>& ties() const;

  /// Library, version and instruction set, as recorded in the model.
  const std::string& description() const;

 private:
  struct Scene;
  explicit RayCaster(std::unique_ptr<Scene> scene);
  std::unique_ptr<Scene> scene_;
};

}  // namespace relume
