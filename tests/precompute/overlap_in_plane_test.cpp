// SPDX-License-Identifier: MIT
#include "precompute/overlap_in_plane.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace relume {
namespace {

using Corners = std::array<glm::vec3, 3>;
using P = glm::vec3;

bool either_way(const Corners& a, const Corners& b) {
  const bool forward = overlap_in_plane(a, b, 10.0f);
  EXPECT_EQ(forward, overlap_in_plane(b, a, 10.0f)) << "it depends on which comes first";
  EXPECT_EQ(forward, overlap_in_plane(a, {b[0], b[2], b[1]}, 10.0f)) << "it depends on the facing";
  return forward;
}

const Corners kTriangle{P(0, 0, 0), P(4, 0, 0), P(0, 4, 0)};

TEST(OverlapInPlane, WhatLiesOnATriangleOverlaps) {
  EXPECT_TRUE(either_way(kTriangle, kTriangle));
  EXPECT_TRUE(either_way(kTriangle, {P(0.5f, 0.5f, 0), P(1, 0.5f, 0), P(0.5f, 1, 0)})) << "inside";
  EXPECT_TRUE(either_way(kTriangle, {P(1, -1, 0), P(2, -1, 0), P(1, 9, 0)})) << "across";
  EXPECT_TRUE(either_way(kTriangle, {P(0, 0, 1e-6f), P(4, 0, 1e-6f), P(0, 4, 1e-6f)})) << "within rounding";
}

TEST(OverlapInPlane, NeighboursDoNot) {
  EXPECT_FALSE(either_way(kTriangle, {P(4, 0, 0), P(4, 4, 0), P(0, 4, 0)})) << "a shared edge";
  EXPECT_FALSE(either_way(kTriangle, {P(0, 0, 0), P(-1, 0, 0), P(0, -1, 0)})) << "a shared corner";
  EXPECT_FALSE(either_way(kTriangle, {P(1, 0, 0), P(2, 0, 0), P(1, -1, 0)})) << "part of an edge";
}

TEST(OverlapInPlane, OtherPlanesDoNot) {
  EXPECT_FALSE(either_way(kTriangle, {P(0, 0, 0.001f), P(4, 0, 0.001f), P(0, 4, 0.001f)})) << "1 mm above";
  EXPECT_FALSE(either_way(kTriangle, {P(1, 1, -1), P(2, 1, 1), P(1, 2, 0)})) << "through it";
  EXPECT_FALSE(either_way(kTriangle, {P(1, 0, 0), P(3, 0, 0), P(1, 0, 2)})) << "standing on it";
}

TEST(OverlapInPlane, DegenerateTrianglesDoNot) {
  EXPECT_FALSE(either_way(kTriangle, {P(1, 1, 0), P(2, 1, 0), P(3, 1, 0)}));
  EXPECT_FALSE(either_way(kTriangle, {P(1, 1, 0), P(1, 1, 0), P(1, 1, 0)}));
}

}  // namespace
}  // namespace relume
