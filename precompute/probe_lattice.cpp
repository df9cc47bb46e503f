// SPDX-License-Identifier: MIT
#include "precompute/probe_lattice.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "precompute/sphere_tracer.h"

namespace relume {
namespace {

constexpr int kLookingDirections = 32;
/// A few back faces are seen through any gap.
constexpr int kMostBackFaces = kLookingDirections / 8;
/// Share of a cell's edges that probes keep off surfaces, and by which they may move.
constexpr float kClearance = 0.02f;
constexpr std::array<float, 3> kMoves{0.05f, 0.15f, 0.33f};

/// Evenly spread: equal areas along z, the golden ratio around it.
std::array<glm::vec3, kLookingDirections> make_directions() {
  std::array<glm::vec3, kLookingDirections> directions;
  for (int i = 0; i < kLookingDirections; ++i) {
    const float turn = float(i) * 0.61803399f;
    directions[std::size_t(i)] =
        sphere_direction((float(i) + 0.5f) / float(kLookingDirections), turn - std::floor(turn));
  }
  return directions;
}

std::optional<glm::vec3> find_room(const Geometry& geometry, const RayCaster& caster, const glm::vec3& corner,
                                   const glm::vec3& edges) {
  const float shortest = std::min({edges.x, edges.y, edges.z});
  const float clearance = std::max(kClearance * shortest, 4.0f * geometry.offset);
  if (in_free_space(geometry, caster, corner, clearance)) return corner;
  for (const float move : kMoves) {
    for (int straight = 1; straight <= 3; ++straight) {
      for (int way = 0; way < 27; ++way) {
        const glm::vec3 step(glm::ivec3(way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1));
        if (int(glm::dot(step, step)) != straight) continue;
        const glm::vec3 moved = corner + move / std::sqrt(float(straight)) * edges * step;
        if (in_free_space(geometry, caster, moved, clearance)) return moved;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

bool in_free_space(const Geometry& geometry, const RayCaster& caster, const glm::vec3& point,
                   float clearance) {
  static const std::array<glm::vec3, kLookingDirections> kAround = make_directions();
  int back_faces = 0;
  for (int first = 0; first < kLookingDirections; first += kPacketSize) {
    RayPacket packet;
    for (std::size_t lane = 0; lane < kPacketSize; ++lane)
      set_ray(packet, lane, point, kAround[std::size_t(first) + lane],
              std::numeric_limits<float>::infinity());
    caster.closest_hits(packet, RaySpread::wide, AlphaTest::solid);
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
      if (packet.triangle[lane] == kNoTriangle) continue;
      if (packet.far[lane] < clearance) return false;
      const SurfaceHit hit{packet.triangle[lane], packet.u[lane], packet.v[lane], Side::front};
      if (!seen_surface(geometry, hit, kAround[std::size_t(first) + lane])) ++back_faces;
    }
  }
  return back_faces <= kMostBackFaces;
}

void ProbeLattice::add(std::vector<LatticePoint> points, const glm::vec3& edges) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::erase_if(points, [&](const LatticePoint& at) { return probes_.contains(at); });
  std::vector<std::optional<glm::vec3>> found(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    found[i] = find_room(geometry_, caster_, place(points[i]), edges);
  });
  for (std::size_t i = 0; i < points.size(); ++i) {
    probes_[points[i]] = found[i] ? std::uint32_t(positions_.size()) : kNoProbe;
    if (found[i]) positions_.push_back(*found[i]);
  }
}

}  // namespace relume
