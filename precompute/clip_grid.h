// SPDX-License-Identifier: MIT
//
// Cutting a triangle along the lines of a unit grid.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <utility>

namespace relume {

/// A vertex in grid coordinates that carries its barycentric coordinates in the triangle that is cut.
struct GridVertex {
  glm::dvec2 position;
  glm::dvec2 barycentric;
};

/// A convex polygon: a triangle cut by at most four lines.
class GridPolygon {
 public:
  void push(const GridVertex& vertex) {
    if (count_ < kCapacity) vertices_[count_++] = vertex;
  }
  std::size_t size() const { return count_; }
  const GridVertex& operator[](std::size_t i) const { return vertices_[i]; }

 private:
  static constexpr std::size_t kCapacity = 12;
  std::array<GridVertex, kCapacity> vertices_;
  std::size_t count_ = 0;
};

/// The part of `polygon` where `keep_above` ? position[axis] >= line : position[axis] <= line (I. Sutherland,
/// G. Hodgman, Reentrant Polygon Clipping, 1974).
inline GridPolygon clip(const GridPolygon& polygon, int axis, double line, bool keep_above) {
  GridPolygon result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const GridVertex& a = polygon[i];
    const GridVertex& b = polygon[(i + 1) % polygon.size()];
    const double da = (a.position[axis] - line) * (keep_above ? 1.0 : -1.0);
    const double db = (b.position[axis] - line) * (keep_above ? 1.0 : -1.0);
    if (da >= 0.0) result.push(a);
    if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) {
      const double t = da / (da - db);
      result.push({glm::mix(a.position, b.position, t), glm::mix(a.barycentric, b.barycentric, t)});
    }
  }
  return result;
}

/// In cells.
inline double area(const GridPolygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i].position, b = polygon[(i + 1) % polygon.size()].position;
    twice += a.x * b.y - b.x * a.y;
  }
  return 0.5 * std::abs(twice);
}

/// Whether a part is no more than what rounding leaves of a contact: slivers would become elements of their
/// own.
inline bool negligible(const GridPolygon& part, const GridPolygon& whole) {
  const double part_area = area(part);
  return part_area < 1e-4 && part_area < 1e-3 * area(whole);
}

/// First and last cell of the grid that the polygon reaches into along `axis`. Contact with a line alone does
/// not count.
inline std::pair<int, int> cell_range(const GridPolygon& polygon, int axis) {
  double lower = polygon[0].position[axis];
  double upper = lower;
  for (std::size_t i = 1; i < polygon.size(); ++i) {
    lower = std::min(lower, polygon[i].position[axis]);
    upper = std::max(upper, polygon[i].position[axis]);
  }
  constexpr double kContact = 1e-6;
  const int first = static_cast<int>(std::floor(lower + kContact));
  return {first, std::max(first, static_cast<int>(std::ceil(upper - kContact)) - 1)};
}

/// Calls visit(x, y, part) for each cell that the polygon reaches into.
template <class Visit>
void for_each_cell(const GridPolygon& polygon, Visit&& visit) {
  const auto [first_row, last_row] = cell_range(polygon, 1);
  for (int row = first_row; row <= last_row; ++row) {
    GridPolygon strip = polygon;
    if (row > first_row) strip = clip(strip, 1, row, true);
    if (row < last_row) strip = clip(strip, 1, row + 1, false);
    if (strip.size() < 3) continue;
    const auto [first_column, last_column] = cell_range(strip, 0);
    for (int column = first_column; column <= last_column; ++column) {
      GridPolygon part = strip;
      if (column > first_column) part = clip(part, 0, column, true);
      if (column < last_column) part = clip(part, 0, column + 1, false);
      if (part.size() >= 3) visit(column, row, part);
    }
  }
}

}  // namespace relume
