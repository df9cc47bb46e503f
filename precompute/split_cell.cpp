// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "precompute/clip_grid.h"
#include "precompute/elements.h"
#include "precompute/views.h"

namespace relume {
namespace {

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

/// Whether they might be one, if they see each other.
bool adjacent(const Clump& a, const Clump& b) {
  return std::abs(a.x - b.x) <= 1 && std::abs(a.y - b.y) <= 1 && a.material == b.material &&
         glm::dot(a.middle.normal, b.middle.normal) >= 0.5f;
}

std::size_t find_root(std::vector<std::size_t>& parents, std::size_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

std::vector<std::vector<Piece>> split_cell(const Geometry& geometry, const Chart& chart, Views& views,
                                           const std::vector<Piece>& pieces, std::uint64_t& rays) {
  std::vector<Clump> clumps = cut_finely(geometry, chart, pieces);
  std::vector<Clump> outside;
  for (Clump& clump : clumps) {
    if (!views.inside(clump.middle, rays)) outside.push_back(clump);
  }
  if (!outside.empty()) clumps = std::move(outside);
  std::vector<std::size_t> parents(clumps.size());
  std::iota(parents.begin(), parents.end(), std::size_t{0});
  for (std::size_t a = 0; a < clumps.size(); ++a) {
    for (std::size_t b = a + 1; b < clumps.size(); ++b) {
      if (find_root(parents, a) == find_root(parents, b) || !adjacent(clumps[a], clumps[b]) ||
          !views.see_each_other(clumps[a].middle, clumps[b].middle, rays))
        continue;
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
