// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "precompute/clip_grid.h"
#include "precompute/elements.h"
#include "precompute/mutual_visibility.h"
#include "precompute/sampling.h"

namespace relume {
namespace {

/// Rays that decide whether a point lies inside other geometry; inside when more than half meet back faces.
constexpr int kInsideRays = 16;

/// Pieces of one sub-cell that agree in material and normal: what is told apart at most.
struct Clump {
  int x = 0, y = 0;
  std::uint32_t material = 0;
  SurfacePoint middle;  ///< of its largest piece
  float largest = 0.0f;
  std::vector<Piece> pieces;
};

void add_to_clump(const Geometry& geometry, Side side, int x, int y, const Piece& piece,
                  std::vector<Clump>& clumps) {
  const std::uint32_t material = geometry.material[piece.shape.triangle];
  const SurfacePoint middle = middle_of(geometry, piece.shape, side);
  auto clump = std::find_if(clumps.begin(), clumps.end(), [&](const Clump& c) {
    return c.x == x && c.y == y && c.material == material && glm::dot(c.middle.normal, middle.normal) > 0.5f;
  });
  if (clump == clumps.end()) clump = clumps.insert(clumps.end(), Clump{x, y, material, middle, 0.0f, {}});
  if (piece.area > clump->largest) {
    clump->largest = piece.area;
    clump->middle = middle;
  }
  clump->pieces.push_back(piece);
}

std::vector<Clump> cut_finely(const Geometry& geometry, const Chart& chart,
                              const std::vector<Piece>& pieces) {
  std::vector<Clump> clumps;
  for (const Piece& piece : pieces) {
    const auto member =
        std::size_t(std::lower_bound(chart.triangles.begin(), chart.triangles.end(), piece.shape.triangle) -
                    chart.triangles.begin());
    const auto& corners = chart.corners[member];
    GridPolygon polygon;
    for (const glm::vec2& uv : piece.shape.corners) {
      const glm::dvec2 at = glm::dvec2(corners[0]) * (1.0 - uv.x - uv.y) +
                            glm::dvec2(corners[1]) * double(uv.x) + glm::dvec2(corners[2]) * double(uv.y);
      polygon.push({at * double(kSubcells), glm::dvec2(uv)});
    }
    for_each_cell(polygon, [&](int x, int y, const GridPolygon& part) {
      if (negligible(part, polygon)) return;
      for (std::size_t k = 2; k < part.size(); ++k) {
        const glm::dvec2 a = part[0].barycentric, b = part[k - 1].barycentric, c = part[k].barycentric;
        const double share = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
        if (!(share > 1e-10)) continue;
        Piece fine = piece;
        fine.shape.corners = {glm::vec2(a), glm::vec2(b), glm::vec2(c)};
        const double solid = geometry.opacity.mean(piece.shape.triangle, fine.shape.corners);
        if (!(solid > 0.0)) continue;
        fine.area = float(share * solid) * geometry.areas[piece.shape.triangle];
        add_to_clump(geometry, chart.side, x, y, fine, clumps);
      }
    });
  }
  return clumps;
}

bool inside_geometry(const Geometry& geometry, const RayCaster& caster, const SurfacePoint& point) {
  static const SobolPoints points(kInsideRays);
  const Frame frame = frame_about(point.normal);
  const glm::vec3 origin = point.position + point.normal * geometry.offset;
  int back_faces = 0;
  for (int first = 0; first < kInsideRays; first += kPacketSize) {
    RayPacket packet;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const SamplePoint s = points.scrambled(std::uint32_t(first + lane), 1);
      const glm::vec3 d = frame.to_world(cosine_direction(s[0], s[1]));
      packet.origin_x[lane] = origin.x, packet.origin_y[lane] = origin.y, packet.origin_z[lane] = origin.z;
      packet.direction_x[lane] = d.x, packet.direction_y[lane] = d.y, packet.direction_z[lane] = d.z;
      packet.near[lane] = 0.0f, packet.far[lane] = std::numeric_limits<float>::infinity();
    }
    caster.closest_hits(packet);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const std::uint32_t t = packet.triangle[lane];
      if (t == kNoTriangle) continue;
      const glm::vec3 d(packet.direction_x[lane], packet.direction_y[lane], packet.direction_z[lane]);
      back_faces += seen_surface(geometry, {t, packet.u[lane], packet.v[lane], Side::front}, d) ? 0 : 1;
    }
  }
  return 2 * back_faces > kInsideRays;
}

bool connected(const Geometry& geometry, const RayCaster& caster, const Clump& a, const Clump& b) {
  if (std::abs(a.x - b.x) > 1 || std::abs(a.y - b.y) > 1 || a.material != b.material) return false;
  if (glm::dot(a.middle.normal, b.middle.normal) < 0.5f) return false;
  return mutually_visible(geometry, caster, a.middle, b.middle);
}

std::size_t find_root(std::vector<std::size_t>& parents, std::size_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

std::vector<std::vector<Piece>> split_cell(const Geometry& geometry, const Chart& chart,
                                           const RayCaster& caster, const std::vector<Piece>& pieces,
                                           std::uint64_t& occlusion_rays) {
  std::vector<Clump> clumps = cut_finely(geometry, chart, pieces);
  occlusion_rays += clumps.size() * kInsideRays;
  std::vector<Clump> outside;
  for (Clump& clump : clumps) {
    if (!inside_geometry(geometry, caster, clump.middle)) outside.push_back(clump);
  }
  if (!outside.empty()) clumps = std::move(outside);
  std::vector<std::size_t> parents(clumps.size());
  std::iota(parents.begin(), parents.end(), std::size_t{0});
  for (std::size_t a = 0; a < clumps.size(); ++a) {
    for (std::size_t b = a + 1; b < clumps.size(); ++b) {
      if (find_root(parents, a) == find_root(parents, b) ||
          !connected(geometry, caster, clumps[a], clumps[b]))
        continue;
      occlusion_rays += 3;
      const auto ra = find_root(parents, a), rb = find_root(parents, b);
      parents[std::max(ra, rb)] = std::min(ra, rb);
    }
  }
  std::vector<std::vector<Piece>> groups(clumps.size());
  for (std::size_t i = 0; i < clumps.size(); ++i) {
    auto& group = groups[find_root(parents, i)];
    group.insert(group.end(), clumps[i].pieces.begin(), clumps[i].pieces.end());
  }
  std::erase_if(groups, [](const auto& group) { return group.empty(); });
  if (groups.empty()) groups.push_back(pieces);
  return groups;
}

}  // namespace relume
