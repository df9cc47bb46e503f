// SPDX-License-Identifier: MIT
#include "precompute/sampling.h"

#include <gtest/gtest.h>

#include <set>

namespace relume {
namespace {

// A (0, m, 2)-net in base 2 puts exactly one of its 2^m points in every box of area 2^-m whose sides are
// dyadic (H. Niederreiter, 1987). Owen scrambling keeps that.
TEST(Sobol, FirstTwoDimensionsAreANetUnderEverySeed) {
  constexpr std::uint32_t kLog = 8, kCount = 1u << kLog;
  const SobolPoints points(kCount);
  for (const std::uint64_t seed : {0ull, 1ull, 0x123456789abcdefull}) {
    for (std::uint32_t columns_log = 0; columns_log <= kLog; ++columns_log) {
      const std::uint32_t columns = 1u << columns_log, rows = 1u << (kLog - columns_log);
      std::set<std::pair<std::uint32_t, std::uint32_t>> boxes;
      for (std::uint32_t i = 0; i < kCount; ++i) {
        const SamplePoint p = points.scrambled(i, seed);
        boxes.insert({std::uint32_t(p[0] * float(columns)), std::uint32_t(p[1] * float(rows))});
      }
      EXPECT_EQ(boxes.size(), kCount) << columns << " x " << rows << " boxes, seed " << seed;
    }
  }
}

TEST(Sobol, EveryDimensionIsStratified) {
  constexpr std::uint32_t kCount = 1024;
  const SobolPoints points(kCount);
  for (std::size_t d = 0; d < 4; ++d) {
    std::set<std::uint32_t> strata;
    for (std::uint32_t i = 0; i < kCount; ++i)
      strata.insert(std::uint32_t(points.scrambled(i, 77)[d] * kCount));
    EXPECT_EQ(strata.size(), kCount) << "dimension " << d;
  }
}

// Boxes of a net that hold 8 points each: 8 neighbours share a box of 1/16 x 1/8 under every seed, and each
// group holds the points that it held.
TEST(Sobol, GroupedPointsAreTheSameAndNeighboursShareABox) {
  constexpr std::uint32_t kCount = 2048, kGrouped = 1024;
  const SobolPoints plain(kCount), grouped(kCount, kGrouped);
  for (const std::uint64_t seed : {0ull, 77ull}) {
    for (const std::uint32_t first : {0u, kGrouped}) {
      std::set<SamplePoint> expected, found;
      for (std::uint32_t i = first; i < first + kGrouped; ++i) {
        expected.insert(plain.scrambled(i, seed));
        found.insert(grouped.scrambled(i, seed));
      }
      EXPECT_EQ(found, expected) << "from " << first;
    }
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const SamplePoint a = grouped.scrambled(i / 8 * 8, seed), b = grouped.scrambled(i, seed);
      EXPECT_LT(std::abs(a[0] - b[0]), 1.0f / 8) << "point " << i;
      EXPECT_LT(std::abs(a[1] - b[1]), 1.0f / 8) << "point " << i;
    }
  }
}

TEST(Sobol, SeedsAreIndependent) {
  const SobolPoints points(256);
  std::size_t equal = 0;
  for (std::uint32_t i = 0; i < 256; ++i)
    equal += points.scrambled(i, 1)[0] == points.scrambled(i, 2)[0] ? 1 : 0;
  EXPECT_LT(equal, 4u);
}

TEST(CosineDirection, HasTheMomentsOfTheCosineDistribution) {
  constexpr std::uint32_t kCount = 4096;
  const SobolPoints points(kCount);
  glm::dvec3 mean(0.0), square(0.0);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const SamplePoint p = points.scrambled(i, 5);
    const glm::dvec3 d(cosine_direction(p[0], p[1]));
    EXPECT_NEAR(glm::length(d), 1.0, 1e-6);
    mean += d / double(kCount);
    square += d * d / double(kCount);
  }
  // E[z] = 2/3, E[z^2] = 1/2, E[x^2] = E[y^2] = 1/4 of the density cos/pi.
  EXPECT_NEAR(mean.z, 2.0 / 3.0, 1e-3);
  EXPECT_NEAR(mean.x, 0.0, 1e-3);
  EXPECT_NEAR(mean.y, 0.0, 1e-3);
  EXPECT_NEAR(square.z, 0.5, 1e-3);
  EXPECT_NEAR(square.x, 0.25, 1e-3);
  EXPECT_NEAR(square.y, 0.25, 1e-3);
}

TEST(TrianglePoint, CoversTheTriangleEvenly) {
  const SobolPoints points(4096);
  glm::dvec2 mean(0.0);
  int lower_half = 0;
  for (std::uint32_t i = 0; i < 4096; ++i) {
    const SamplePoint p = points.scrambled(i, 9);
    const glm::vec2 b = triangle_point(p[2], p[3]);
    EXPECT_GE(b.x, 0.0f);
    EXPECT_GE(b.y, 0.0f);
    EXPECT_LE(b.x + b.y, 1.0f + 1e-6f);
    mean += glm::dvec2(b) / 4096.0;
    lower_half += b.x < b.y ? 1 : 0;
  }
  EXPECT_NEAR(mean.x, 1.0 / 3.0, 2e-3);
  EXPECT_NEAR(mean.y, 1.0 / 3.0, 2e-3);
  EXPECT_NEAR(lower_half, 2048, 16);
}

TEST(FrameAbout, IsOrthonormalAndRightHanded) {
  for (const glm::vec3 n :
       {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(1, 0, 0), glm::vec3(0.6f, -0.64f, 0.48f)}) {
    const Frame f = frame_about(n);
    EXPECT_NEAR(glm::length(glm::cross(f.tangent, f.bitangent) - n), 0.0f, 1e-6f);
    EXPECT_NEAR(glm::dot(f.tangent, f.bitangent), 0.0f, 1e-6f);
    EXPECT_NEAR(glm::length(f.tangent), 1.0f, 1e-6f);
  }
}

}  // namespace
}  // namespace relume
