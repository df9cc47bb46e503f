// SPDX-License-Identifier: MIT
#include "precompute/elements.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "precompute/cells.h"
#include "precompute/clip_grid.h"
#include "precompute/views.h"

namespace relume {
namespace {

/// Pieces of one cell whose normals differ by more than 45 degrees, or that lie further apart than this many
/// lumels, may not be one element.
constexpr float kCosMixed = 0.7f;
constexpr float kMaxExtentLumels = 3.0f;

/// Parts smaller than this share of their triangle and of their lumel are rounding.
constexpr double kSmallestPart = 1e-9;

void cut_chart(const Geometry& geometry, const Chart& chart, std::uint32_t chart_index,
               const glm::uvec2& position, std::uint32_t width, std::vector<Piece>& pieces) {
  for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
    const std::uint32_t t = chart.triangles[i];
    GridPolygon triangle;
    constexpr std::array<glm::dvec2, 3> kCorners{glm::dvec2{0, 0}, glm::dvec2{1, 0}, glm::dvec2{0, 1}};
    for (std::size_t k = 0; k < 3; ++k) triangle.push({glm::dvec2(chart.corners[i][k]), kCorners[k]});
    for_each_cell(triangle, [&](int x, int y, const GridPolygon& part) {
      if (negligible(part, triangle)) return;
      const auto cx =
          std::clamp<std::uint32_t>(std::uint32_t(std::max(x, 0)), 0, chart.width - 1) + position.x;
      const auto cy =
          std::clamp<std::uint32_t>(std::uint32_t(std::max(y, 0)), 0, chart.height - 1) + position.y;
      for (std::size_t k = 2; k < part.size(); ++k) {
        const glm::dvec2 a = part[0].barycentric, b = part[k - 1].barycentric, c = part[k].barycentric;
        const double share = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
        if (!(share > kSmallestPart)) continue;
        const SurfacePiece shape{t, {glm::vec2(a), glm::vec2(b), glm::vec2(c)}};
        const double solid = geometry.opacity.mean(t, shape.corners);
        if (!(solid > 0.0)) continue;
        pieces.push_back({shape, float(share * solid) * geometry.areas[t], cy * width + cx, chart_index});
      }
    });
  }
}

/// The element of a group of pieces: its position is the middle of the piece nearest to the centre of area.
Element element_of(const Geometry& geometry, const std::vector<Chart>& charts,
                   std::span<const Piece> pieces) {
  Element element;
  const Side side = charts[pieces[0].chart].side;
  glm::dvec3 centre(0.0);
  double area = 0.0;
  for (const Piece& piece : pieces) {
    centre += double(piece.area) * glm::dvec3(middle_of(geometry, piece.shape, side).position);
    area += piece.area;
  }
  centre /= area;
  double nearest = std::numeric_limits<double>::max();
  for (const Piece& piece : pieces) {
    const SurfacePoint middle = middle_of(geometry, piece.shape, side);
    const double distance = glm::length(glm::dvec3(middle.position) - centre);
    if (distance >= nearest) continue;
    nearest = distance;
    element.position = middle.position;
    element.normal = middle.normal;
    element.material = geometry.material[piece.shape.triangle];
  }
  element.area = float(area);
  element.cell = pieces[0].cell;
  element.chart = pieces[0].chart;
  element.piece_count = std::uint32_t(pieces.size());
  return element;
}

/// Whether the pieces of a cell disagree in material or normal, or lie apart.
bool mixed(const Geometry& geometry, const Element& cell, std::span<const Piece> pieces, Side side) {
  const float reach = kMaxExtentLumels * std::sqrt(std::max(cell.area, 1e-30f));
  for (const Piece& piece : pieces) {
    if (geometry.material[piece.shape.triangle] != cell.material) return true;
    const SurfacePoint middle = middle_of(geometry, piece.shape, side);
    if (glm::dot(middle.normal, cell.normal) < kCosMixed) return true;
    if (pieces.size() > 1 &&
        glm::length(middle.position - cell.position) > reach + kMaxExtentLumels * std::sqrt(piece.area))
      return true;
  }
  return false;
}

Cells gather_cells(const Geometry& geometry, const std::vector<Chart>& charts,
                   const std::vector<Piece>& pieces, const AtlasLayout& layout) {
  std::vector<std::uint32_t> first;  // pieces of cells
  for (std::uint32_t p = 0; p < pieces.size(); ++p) {
    if (p == 0 || pieces[p].cell != pieces[p - 1].cell) first.push_back(p);
  }
  Cells cells;
  cells.width = layout.width, cells.height = layout.height;
  cells.index.assign(std::size_t(layout.width) * layout.height, kNone);
  cells.whole.resize(first.size());
  cells.split.assign(first.size(), 0);
  cells.walled.assign(first.size(), 0);
  tbb::parallel_for(std::size_t{0}, first.size(), [&](std::size_t i) {
    const std::size_t end = i + 1 < first.size() ? first[i + 1] : pieces.size();
    const std::span<const Piece> group(pieces.data() + first[i], end - first[i]);
    Element element = element_of(geometry, charts, group);
    element.first_piece = first[i];
    cells.index[element.cell] = std::uint32_t(i);
    cells.split[i] = mixed(geometry, element, group, charts[element.chart].side) ? 1 : 0;
    cells.whole[i] = element;
  });
  return cells;
}

void recognise_cells(const std::vector<Piece>& pieces, const KnownCells& known, Cells& cells) {
  cells.known.assign(cells.whole.size(), 0);
  tbb::parallel_for(std::size_t{0}, cells.whole.size(), [&](std::size_t i) {
    const Element& cell = cells.whole[i];
    cells.known[i] = known.whole(cell, std::span(pieces).subspan(cell.first_piece, cell.piece_count)) ? 1 : 0;
  });
}

/// Pieces of the elements of one cell; none where it stays whole.
using Groups = std::vector<std::vector<Piece>>;

/// Of cells that are split, as split_cell groups them.
std::vector<Groups> split_cells(const Geometry& geometry, const std::vector<Chart>& charts, Views& views,
                                const Cells& cells, const std::vector<Piece>& pieces,
                                std::uint64_t& traced_rays) {
  std::vector<Groups> groups(cells.whole.size());
  std::atomic<std::uint64_t> rays{0};
  tbb::parallel_for(std::size_t{0}, cells.whole.size(), [&](std::size_t i) {
    if (cells.split[i] == 0) return;
    const Element& cell = cells.whole[i];
    const auto first = pieces.begin() + cell.first_piece;
    std::uint64_t traced = 0;
    groups[i] = split_cell(geometry, charts[cell.chart], views, {first, first + cell.piece_count}, traced);
    rays += traced;
  });
  traced_rays += rays;
  return groups;
}

/// Where the elements of a cell begin.
struct Beginning {
  std::uint32_t element = 0, piece = 0;
};

/// Per whole cell, and the totals at the end.
std::vector<Beginning> beginnings(const Cells& cells, const std::vector<Groups>& groups) {
  std::vector<Beginning> first(1);
  first.reserve(cells.whole.size() + 1);
  for (std::size_t i = 0; i < cells.whole.size(); ++i) {
    Beginning next = first.back();
    if (cells.split[i] == 0) next.element += 1, next.piece += cells.whole[i].piece_count;
    for (const auto& group : groups[i]) next.element += 1, next.piece += std::uint32_t(group.size());
    first.push_back(next);
  }
  return first;
}

/// Final elements: whole cells as they are, the others as split_cell groups them.
void settle_elements(const Geometry& geometry, const std::vector<Chart>& charts, Views& views,
                     const Cells& cells, const std::vector<Piece>& pieces, SystemSurface& surface) {
  const std::vector<Groups> groups =
      split_cells(geometry, charts, views, cells, pieces, surface.occlusion_rays);
  const std::vector<Beginning> first = beginnings(cells, groups);
  surface.elements.resize(first.back().element);
  surface.pieces.resize(first.back().piece);
  surface.first_element.assign(cells.index.size() + 1, 0);
  tbb::parallel_for(std::size_t{0}, cells.whole.size(), [&](std::size_t i) {
    const Element& cell = cells.whole[i];
    Beginning at = first[i];
    surface.first_element[cell.cell + 1] = first[i + 1].element - at.element;
    const auto put = [&](Element element, std::span<const Piece> group) {
      element.first_piece = at.piece, element.piece_count = std::uint32_t(group.size());
      element.walled = cells.walled[i] != 0;
      element.split = groups[i].size() > 1;
      std::copy(group.begin(), group.end(), surface.pieces.begin() + at.piece);
      surface.elements[at.element] = element;
      at.element += 1, at.piece += element.piece_count;
    };
    if (cells.split[i] == 0) put(cell, std::span(pieces).subspan(cell.first_piece, cell.piece_count));
    for (const auto& group : groups[i]) put(element_of(geometry, charts, group), group);
  });
  for (std::size_t c = 1; c < surface.first_element.size(); ++c)
    surface.first_element[c] += surface.first_element[c - 1];
}

void link_elements(Views& views, const Cells& cells, SystemSurface& surface) {
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links(cells.whole.size());
  std::atomic<std::uint64_t> rays{0};
  tbb::parallel_for(std::size_t{0}, cells.whole.size(), [&](std::size_t a) {
    std::uint64_t traced = 0;
    for_each_neighbour(cells, std::uint32_t(a), [&](std::uint32_t b) {
      const std::uint32_t cell_a = cells.whole[a].cell, cell_b = cells.whole[b].cell;
      const bool both_whole = cells.split[a] == 0 && cells.split[b] == 0;
      for (auto i = surface.first_element[cell_a]; i < surface.first_element[cell_a + 1]; ++i) {
        for (auto j = surface.first_element[cell_b]; j < surface.first_element[cell_b + 1]; ++j) {
          const Element &e = surface.elements[i], &f = surface.elements[j];
          // find_walls has already seen that whole neighbours see each other.
          if (linkable(e, f) && (both_whole || views.see_each_other(point_of(e), point_of(f), traced)))
            links[a].emplace_back(i, j);
        }
      }
    });
    rays += traced;
  });
  surface.occlusion_rays += rays;
  for (const auto& list : links) surface.links.insert(surface.links.end(), list.begin(), list.end());
}

}  // namespace

SurfacePoint middle_of(const Geometry& geometry, const SurfacePiece& shape, Side side) {
  const glm::vec2 uv = (shape.corners[0] + shape.corners[1] + shape.corners[2]) / 3.0f;
  return {geometry.point(shape.triangle, uv.x, uv.y), geometry.normal(shape.triangle, side)};
}

std::vector<Piece> cut_into_cells(const Geometry& geometry, const std::vector<Chart>& charts,
                                  const AtlasLayout& layout) {
  std::vector<std::vector<Piece>> parts(layout.charts.size());
  tbb::parallel_for(std::size_t{0}, layout.charts.size(), [&](std::size_t i) {
    cut_chart(geometry, charts[layout.charts[i]], layout.charts[i], layout.positions[i], layout.width,
              parts[i]);
  });
  // Sorted by counting, so that those of a cell keep their order.
  std::vector<std::uint32_t> next(std::size_t(layout.width) * layout.height + 1, 0);
  for (const auto& part : parts) {
    for (const Piece& piece : part) ++next[piece.cell + 1];
  }
  for (std::size_t c = 1; c < next.size(); ++c) next[c] += next[c - 1];
  std::vector<Piece> pieces(next.back());
  for (const auto& part : parts) {
    for (const Piece& piece : part) pieces[next[piece.cell]++] = piece;
  }
  return pieces;
}

SystemSurface make_elements(const Geometry& geometry, const std::vector<Chart>& charts,
                            const AtlasLayout& layout, Views& views, const KnownCells* known) {
  SystemSurface surface;
  surface.width = layout.width;
  surface.height = layout.height;
  const auto pieces = cut_into_cells(geometry, charts, layout);
  Cells cells = gather_cells(geometry, charts, pieces, layout);
  if (known != nullptr) recognise_cells(pieces, *known, cells);
  surface.occlusion_rays = find_walls(geometry, charts, pieces, views, known, cells);
  settle_elements(geometry, charts, views, cells, pieces, surface);
  link_elements(views, cells, surface);
  return surface;
}

}  // namespace relume
