// SPDX-License-Identifier: MIT
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <glm/geometric.hpp>

#include "precompute/cells.h"

namespace relume {
namespace {

/// Whether a cell saw what is so far away before, itself or another, and nothing changed there.
bool still_visible(const Cells& cells, const KnownCells* known, std::size_t a, std::size_t b,
                   const glm::vec3& other) {
  if (known == nullptr || cells.known[a] == 0 || cells.known[b] == 0) return false;
  const float distance = glm::length(other - cells.whole[a].position);
  return !known->disturbed(cells.whole[a].position, kLiftReach * distance);
}

/// Whether all eight neighbours of a cell may show walls between them and it.
std::vector<std::uint8_t> find_surrounded(const Cells& cells) {
  std::vector<std::uint8_t> neighbours(cells.whole.size(), 0);
  for (std::uint32_t a = 0; a < cells.whole.size(); ++a) {
    for_each_neighbour(cells, a, [&](std::uint32_t b) {
      if (linkable(cells.whole[a], cells.whole[b])) ++neighbours[a], ++neighbours[b];
    });
  }
  for (std::uint8_t& count : neighbours) count = count == 8 ? 1 : 0;
  return neighbours;
}

/// The corners of a cell: of those of its pieces the ones that are farthest from its middle and each other,
/// drawn in by twice what rays are lifted by, so that walls that end there do not count.
std::vector<SurfacePoint> corners_of(const Geometry& geometry, const Element& cell,
                                     std::span<const Piece> pieces, Side side) {
  constexpr std::size_t kCorners = 4;
  std::vector<SurfacePoint> all, chosen;
  std::vector<float> distances;
  for (const Piece& piece : pieces) {
    for (const glm::vec2& corner : piece.shape.corners) {
      all.push_back({geometry.point(piece.shape.triangle, corner.x, corner.y),
                     geometry.normal(piece.shape.triangle, side)});
      distances.push_back(glm::length(all.back().position - cell.position));
    }
  }
  while (chosen.size() < kCorners) {
    const auto farthest = std::max_element(distances.begin(), distances.end());
    if (*farthest <= 4.0f * geometry.offset) break;
    SurfacePoint corner = all[std::size_t(farthest - distances.begin())];
    for (std::size_t i = 0; i < all.size(); ++i)
      distances[i] = std::min(distances[i], glm::length(all[i].position - corner.position));
    const glm::vec3 inward = cell.position - corner.position;
    corner.position += inward * (2.0f * geometry.offset / glm::length(inward));
    chosen.push_back(corner);
  }
  return chosen;
}

/// What is asked about walls, and what is known beforehand.
struct WallSearch {
  const Geometry& geometry;
  const std::vector<Chart>& charts;
  std::span<const Piece> pieces;
  Views& views;
  const KnownCells* known;
  const Cells& cells;

  template <class Visit>
  void for_each_linkable(std::size_t a, Visit&& visit) const {
    for_each_neighbour(cells, std::uint32_t(a), [&](std::uint32_t b) {
      if (linkable(cells.whole[a], cells.whole[b])) visit(b);
    });
  }
  std::vector<SurfacePoint> corners(std::size_t a) const {
    const Element& cell = cells.whole[a];
    return corners_of(geometry, cell, pieces.subspan(cell.first_piece, cell.piece_count),
                      charts[cell.chart].side);
  }
};

/// What was asked of two points, and the answer.
struct Sight {
  SurfacePoint from, to;
  bool seen = false;
};

/// Between the points of a cell: from the middle to its corners, then from each that is in sight to those
/// that are not yet, so that a post in between does not count.
struct OwnSights {
  std::vector<Sight> asked;
  bool cut = false;  ///< a corner stays out of sight
};

OwnSights look_for_corners(const WallSearch& search, std::size_t a, std::uint64_t& rays) {
  std::vector<SurfacePoint> hidden = search.corners(a), seen{point_of(search.cells.whole[a])};
  OwnSights sights;
  for (std::size_t i = 0; i < seen.size() && !hidden.empty(); ++i) {
    const SurfacePoint from = seen[i];
    std::vector<SurfacePoint> still_hidden;
    for (const SurfacePoint& corner : hidden) {
      const bool visible = search.views.ask(from, corner, rays);
      sights.asked.push_back({from, corner, visible});
      (visible ? seen : still_hidden).push_back(corner);
    }
    hidden = std::move(still_hidden);
  }
  sights.cut = !hidden.empty();
  return sights;
}

/// Whether all corners were in sight before, and nothing changed there.
bool still_whole(const WallSearch& search, std::size_t a) {
  if (search.known == nullptr) return false;
  const std::vector<SurfacePoint> corners = search.corners(a);  // the farthest first
  return corners.empty() || still_visible(search.cells, search.known, a, a, corners[0].position);
}

/// What was found about a cell.
struct Blocked {
  std::vector<std::uint32_t> neighbours;  ///< the middle of the cell does not see theirs
  bool cut = false;                       ///< a corner of it is out of sight
};

Blocked look_around(const WallSearch& search, std::size_t a, bool surrounded, std::uint64_t& rays) {
  const Cells& cells = search.cells;
  Blocked blocked;
  search.for_each_linkable(a, [&](std::uint32_t b) {
    if (still_visible(cells, search.known, a, b, cells.whole[b].position)) return;
    if (!search.views.ask(point_of(cells.whole[a]), point_of(cells.whole[b]), rays))
      blocked.neighbours.push_back(b);
  });
  if (!surrounded && !still_whole(search, a)) blocked.cut = look_for_corners(search, a, rays).cut;
  return blocked;
}

/// Of cells that stay whole, their elements tell the next time what they saw. Of the others, corners are
/// asked once more: nobody did where a cell was whole before, and few are split.
void keep_answers(const WallSearch& search, std::size_t a, bool surrounded, const Blocked& blocked,
                  std::uint64_t& rays) {
  const Cells& cells = search.cells;
  const SurfacePoint middle = point_of(cells.whole[a]);
  search.for_each_linkable(a, [&](std::uint32_t b) {
    if (cells.split[a] == 0 && cells.split[b] == 0) return;
    const auto found = std::find(blocked.neighbours.begin(), blocked.neighbours.end(), b);
    search.views.keep(middle, point_of(cells.whole[b]), found == blocked.neighbours.end());
  });
  if (surrounded || cells.split[a] == 0 || !search.views.records()) return;
  for (const Sight& sight : look_for_corners(search, a, rays).asked)
    search.views.keep(sight.from, sight.to, sight.seen);
}

}  // namespace

std::uint64_t find_walls(const Geometry& geometry, const std::vector<Chart>& charts,
                         std::span<const Piece> pieces, Views& views, const KnownCells* known, Cells& cells) {
  const WallSearch search{geometry, charts, pieces, views, known, cells};
  const std::vector<std::uint8_t> surrounded = find_surrounded(cells);
  std::vector<Blocked> blocked(cells.whole.size());
  std::atomic<std::uint64_t> rays{0};
  tbb::parallel_for(std::size_t{0}, cells.whole.size(), [&](std::size_t a) {
    std::uint64_t traced = 0;
    blocked[a] = look_around(search, a, surrounded[a] != 0, traced);
    rays += traced;
  });
  const auto mark = [&](std::size_t a) { cells.split[a] = cells.walled[a] = 1; };
  for (std::size_t a = 0; a < blocked.size(); ++a) {
    for (const std::uint32_t b : blocked[a].neighbours) mark(a), mark(b);
    if (blocked[a].cut) mark(a);
  }
  tbb::parallel_for(std::size_t{0}, cells.whole.size(), [&](std::size_t a) {
    std::uint64_t traced = 0;
    keep_answers(search, a, surrounded[a] != 0, blocked[a], traced);
    rays += traced;
  });
  return rays;
}

}  // namespace relume
