// SPDX-License-Identifier: MIT
#include "precompute/clip_grid.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <map>

namespace relume {
namespace {

GridPolygon triangle(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  GridPolygon polygon;
  polygon.push({a, {0, 0}});
  polygon.push({b, {1, 0}});
  polygon.push({c, {0, 1}});
  return polygon;
}

std::map<std::pair<int, int>, double> areas_by_cell(const GridPolygon& polygon) {
  std::map<std::pair<int, int>, double> cells;
  for_each_cell(polygon, [&](int x, int y, const GridPolygon& part) { cells[{x, y}] += area(part); });
  return cells;
}

//  y
//  2 |\ .           The right triangle with legs of 2 covers one whole
//  1 |_|_\ .        cell and halves of two.
//  0 |_|__|_\  x
TEST(ForEachCell, RightTriangleOverFourCells) {
  const auto cells = areas_by_cell(triangle({0, 0}, {2, 0}, {0, 2}));
  ASSERT_EQ(cells.size(), 3u);
  EXPECT_DOUBLE_EQ(cells.at({0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(cells.at({1, 0}), 0.5);
  EXPECT_DOUBLE_EQ(cells.at({0, 1}), 0.5);
}

TEST(ForEachCell, PartsAddUpToTheTriangle) {
  const GridPolygon polygon = triangle({0.3, 0.2}, {17.9, 5.4}, {4.1, 12.7});
  double sum = 0.0;
  for (const auto& [cell, a] : areas_by_cell(polygon)) sum += a;
  EXPECT_NEAR(sum, area(polygon), 1e-9);
}

TEST(ForEachCell, BarycentricCoordinatesFollowTheCut) {
  const glm::dvec2 a(0.5, 0.5), b(5.25, 1.0), c(2.0, 4.75);
  for_each_cell(triangle(a, b, c), [&](int x, int y, const GridPolygon& part) {
    for (std::size_t i = 0; i < part.size(); ++i) {
      const glm::dvec2 uv = part[i].barycentric;
      const glm::dvec2 at = a * (1.0 - uv.x - uv.y) + b * uv.x + c * uv.y;
      EXPECT_NEAR(glm::distance(at, part[i].position), 0.0, 1e-12);
      EXPECT_GE(at.x, x - 1e-9);
      EXPECT_LE(at.x, x + 1 + 1e-9);
      EXPECT_GE(at.y, y - 1e-9);
      EXPECT_LE(at.y, y + 1 + 1e-9);
    }
  });
}

TEST(ForEachCell, ASmallTriangleStaysWhole) {
  const auto cells = areas_by_cell(triangle({3.2, 7.1}, {3.4, 7.2}, {3.3, 7.8}));
  ASSERT_EQ(cells.size(), 1u);
  EXPECT_EQ(cells.begin()->first, std::make_pair(3, 7));
}

TEST(ForEachCell, TouchingALineDoesNotReachAcrossIt) {
  EXPECT_EQ(areas_by_cell(triangle({0, 0}, {1, 0}, {0, 1})).size(), 1u);
}

TEST(Negligible, OnlyWhatIsSmallAgainstTheCellAndAgainstTheWhole) {
  const GridPolygon wall = triangle({0, 0}, {40, 0}, {0, 20}), speck = triangle({0, 0}, {1e-3, 0}, {0, 1e-3});
  EXPECT_TRUE(negligible(triangle({3, 0}, {3, 1}, {3 + 1e-5, 0}), wall));
  EXPECT_FALSE(negligible(triangle({3, 0}, {3, 1}, {3.01, 0}), wall));
  EXPECT_FALSE(negligible(speck, speck));
}

}  // namespace
}  // namespace relume
