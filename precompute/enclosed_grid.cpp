// SPDX-License-Identifier: MIT
#include "precompute/enclosed_grid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

namespace relume {
namespace {

constexpr int kGridPoints = 32;  ///< along the longest side of the scene

using Directions = std::array<glm::vec3, kLookDirections>;

LookGrid grid_over(const Geometry& geometry) {
  LookGrid grid;
  const glm::vec3 extent = geometry.upper - geometry.lower;
  grid.lower = geometry.lower;
  grid.step = std::max({extent.x, extent.y, extent.z}) / kGridPoints;
  if (grid.step > 0.0f)
    grid.size = glm::max(glm::ivec3(1), glm::ivec3(glm::ceil(extent / grid.step - 1e-3f)));
  return grid;
}

bool open_with(const PointLook& look, int more) {
  return std::popcount(look.escaped) + more > kMaxEscapes * kLookDirections ||
         std::popcount(look.back) + more > kMaxBackFaces * kLookDirections;
}

bool open(const PointLook& look) {
  return open_with(look, 0);
}

/// Whether no more rays are needed to know.
bool decided(const PointLook& look) {
  return open(look) || !open_with(look, kLookDirections - int(look.rays));
}

/// One over each coordinate of the directions.
using Inverses = std::array<std::array<float, kLookDirections>, 3>;
using Flags = std::array<std::uint8_t, kLookDirections>;

/// Sets the flags of directions from a point that meet a box (by slabs: T. Kay, J. Kajiya, Ray Tracing
/// Complex Scenes, 1986), or that rounding cannot tell.
[[gnu::target_clones("avx2", "default")]] void add_meeting(const Inverses& inverses, const glm::vec3& lower,
                                                           const glm::vec3& upper, Flags& flags) {
  for (std::size_t i = 0; i < flags.size(); ++i) {
    float enter = 0.0f, leave = std::numeric_limits<float>::max();
    for (int axis = 0; axis < 3; ++axis) {
      const float a = lower[axis] * inverses[std::size_t(axis)][i],
                  b = upper[axis] * inverses[std::size_t(axis)][i];
      enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
    }
    flags[i] |= enter > leave ? 0u : 1u;
  }
}

/// Directions from a point that may meet one of the boxes, as bits.
std::uint64_t meeting(const Inverses& inverses, const glm::vec3& from, std::span<const Box> boxes) {
  Flags flags{};
  for (const Box& box : boxes) add_meeting(inverses, box.lower - from, box.upper - from, flags);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < flags.size(); ++i) bits |= std::uint64_t{flags[i]} << i;
  return bits;
}

/// What the lanes `asked` meet in one direction.
void trace(const Geometry& geometry, const RayCaster& caster, const glm::vec3& direction, std::uint32_t asked,
           RayPacket packet, std::span<PointLook> looks) {
  packet.direction_x.fill(direction.x);
  packet.direction_y.fill(direction.y);
  packet.direction_z.fill(direction.z);
  for (std::size_t i = 0; i < std::size_t(kPacketSize); ++i)
    packet.far[i] = (asked >> i & 1u) != 0 ? std::numeric_limits<float>::infinity() : -1.0f;
  caster.closest_hits(packet, RaySpread::narrow);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if ((asked >> i & 1u) == 0) continue;
    const std::uint32_t triangle = packet.triangle[i];
    const std::uint64_t bit = std::uint64_t{1} << looks[i].rays;
    if (triangle == kNoTriangle) {
      looks[i].escaped |= bit;
    } else if (!seen_surface(geometry, {triangle, packet.u[i], packet.v[i], Side::front}, direction)) {
      looks[i].back |= bit;
    }
  }
}

/// Of so many neighbours along a row of the grid. Rays of one direction go together, for they are traced
/// quicker so; no more than it takes to know. `known` looks, if any, are right in all but the directions that
/// `changed` says.
void look_around(const Geometry& geometry, const RayCaster& caster, const Directions& directions,
                 const EnclosedGrid& grid, std::size_t first, std::span<const PointLook> known,
                 std::span<const std::uint64_t> changed, std::span<PointLook> looks) {
  RayPacket packet{};
  for (std::size_t i = 0; i < std::size_t(kPacketSize); ++i) {
    const glm::vec3 from = grid.point(first + std::min(i, looks.size() - 1));
    packet.origin_x[i] = from.x, packet.origin_y[i] = from.y, packet.origin_z[i] = from.z;
  }
  for (std::uint32_t d = 0; d < std::uint32_t(kLookDirections); ++d) {
    const std::uint64_t bit = std::uint64_t{1} << d;
    std::uint32_t asked = 0, looked = 0;
    for (std::size_t i = 0; i < looks.size(); ++i) {
      if (decided(looks[i])) continue;
      looked |= 1u << i;
      if (known.empty() || d >= known[i].rays || (changed[i] & bit) != 0) {
        asked |= 1u << i;
      } else {
        looks[i].escaped |= known[i].escaped & bit, looks[i].back |= known[i].back & bit;
      }
    }
    if (looked == 0) return;
    if (asked != 0) trace(geometry, caster, directions[d], asked, packet, looks);
    for (std::size_t i = 0; i < looks.size(); ++i) looks[i].rays += looked >> i & 1u;
  }
}

}  // namespace

glm::vec3 sphere_direction(int i, int count) {
  const double z = 1.0 - (2.0 * i + 1.0) / count;
  const double angle = 2.39996322972865332 * i;
  const double radius = std::sqrt(1.0 - z * z);
  return glm::vec3(radius * std::cos(angle), z, radius * std::sin(angle));
}

EnclosedGrid find_enclosed(const Geometry& geometry, const RayCaster& caster, const EarlierLooks* earlier) {
  EnclosedGrid grid{grid_over(geometry), {}, {}};
  if (!(grid.grid.step > 0.0f)) return grid;
  Directions directions;
  Inverses inverses;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    directions[i] = sphere_direction(int(i), kLookDirections);
    for (int axis = 0; axis < 3; ++axis) inverses[std::size_t(axis)][i] = 1.0f / directions[i][axis];
  }
  const std::size_t points = grid.grid.points();
  grid.looks.resize(points), grid.enclosed.resize(points);
  const bool known = earlier != nullptr && earlier->old.look_grid == grid.grid;
  tbb::parallel_for(std::size_t{0}, (points + kPacketSize - 1) / kPacketSize, [&](std::size_t p) {
    const std::size_t first = p * kPacketSize, count = std::min<std::size_t>(kPacketSize, points - first);
    std::span<const PointLook> old;
    std::array<std::uint64_t, kPacketSize> changed{};
    if (known) old = std::span(earlier->old.looks).subspan(first, count);
    for (std::size_t i = 0; i < old.size(); ++i)
      changed[i] = meeting(inverses, grid.point(first + i), earlier->changed);
    const std::span<PointLook> looks = std::span(grid.looks).subspan(first, count);
    look_around(geometry, caster, directions, grid, first, old, changed, looks);
    for (std::size_t i = 0; i < count; ++i) grid.enclosed[first + i] = open(looks[i]) ? 0 : 1;
  });
  return grid;
}

}  // namespace relume
