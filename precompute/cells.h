// SPDX-License-Identifier: MIT
//
// Cells of the lumel grid while elements are made of them: which have a wall in them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <span>
#include <vector>

#include "precompute/charts.h"
#include "precompute/elements.h"
#include "precompute/geometry.h"
#include "precompute/views.h"

namespace relume {

/// One element per covered cell, before any is split.
struct Cells {
  std::uint32_t width = 0, height = 0;  ///< of the lightmap
  std::vector<Element> whole;           ///< ascending by cell; piece_count and first_piece of the cut pieces
  std::vector<std::uint32_t> index;     ///< per cell of the lightmap: into `whole`, or kNone
  std::vector<std::uint8_t> split;      ///< per whole: has to be looked at closely
  std::vector<std::uint8_t> walled;     ///< per whole
  std::vector<std::uint8_t> known;      ///< per whole: it was one before, and saw its neighbours; empty: none
};

/// Whether two elements of neighbouring cells may be linked, if they see each other.
inline bool linkable(const Element& a, const Element& b) {
  return a.material == b.material && glm::dot(a.normal, b.normal) > 0.5f;
}

inline SurfacePoint point_of(const Element& element) {
  return {element.position, element.normal};
}

/// Calls visit(b) for neighbours b of a covered cell of the same chart, so that each pair of the eight
/// neighbours comes once.
template <class Visit>
void for_each_neighbour(const Cells& cells, std::uint32_t a, Visit&& visit) {
  const int x = int(cells.whole[a].cell % cells.width), y = int(cells.whole[a].cell / cells.width);
  constexpr std::array<std::array<int, 2>, 4> kSteps{{{1, 0}, {-1, 1}, {0, 1}, {1, 1}}};
  for (const auto& step : kSteps) {
    const int nx = x + step[0], ny = y + step[1];
    if (nx < 0 || nx >= int(cells.width) || ny >= int(cells.height)) continue;
    const std::uint32_t b = cells.index[std::size_t(ny) * cells.width + std::size_t(nx)];
    if (b != kNone && cells.whole[b].chart == cells.whole[a].chart) visit(b);
  }
}

/// Marks as walled, and to be split, the cells between whose middles something stands, and those that have a
/// corner out of sight of the rest. The latter is asked where neighbours are missing: others show by them
/// whether a wall runs through. `pieces` are those of cut_into_cells; `known` may be missing, and goes
/// with Cells::known. Returns how many rays were traced.
std::uint64_t find_walls(const Geometry& geometry, const std::vector<Chart>& charts,
                         std::span<const Piece> pieces, Views& views, const KnownCells* known, Cells& cells);

}  // namespace relume
