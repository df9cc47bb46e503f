// SPDX-License-Identifier: MIT
#include "precompute/ray_caster.h"

#include <gtest/gtest.h>

#include <limits>

namespace relume {
namespace {

const std::vector<glm::vec3> kSquare{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

RayPacket one_ray(glm::vec3 origin, glm::vec3 direction) {
  RayPacket packet{};
  packet.far.fill(-1.0f);
  packet.origin_x[0] = origin.x, packet.origin_y[0] = origin.y, packet.origin_z[0] = origin.z;
  packet.direction_x.fill(direction.x), packet.direction_y.fill(direction.y),
      packet.direction_z.fill(direction.z);
  packet.far[0] = std::numeric_limits<float>::infinity();
  return packet;
}

TEST(RayCaster, ReportsTriangleDistanceAndBarycentrics) {
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  const auto caster = RayCaster::create(kSquare, triangles);
  ASSERT_TRUE(caster);
  RayPacket packet = one_ray({0.5f, 0.25f, 2.0f}, {0, 0, -1});
  caster->closest_hits(packet);
  EXPECT_EQ(packet.triangle[0], 0u);
  EXPECT_FLOAT_EQ(packet.far[0], 2.0f);
  // (0.5, 0.25) = (1 - u - v) (0, 0) + u (1, 0) + v (1, 1)
  EXPECT_FLOAT_EQ(packet.u[0], 0.25f);
  EXPECT_FLOAT_EQ(packet.v[0], 0.25f);
  EXPECT_EQ(packet.triangle[1], kNoTriangle) << "an unused lane met something";
}

TEST(RayCaster, CoincidentTrianglesGoToTheLowestIndexInAnyOrder) {
  for (const bool reversed : {false, true}) {
    std::vector<std::array<std::uint32_t, 3>> triangles(64, {0, 1, 2});
    if (reversed) triangles.insert(triangles.begin(), {0, 2, 3});
    const auto caster = RayCaster::create(kSquare, triangles);
    ASSERT_TRUE(caster);
    RayPacket packet = one_ray({0.9f, 0.1f, 1.0f}, {0, 0, -1});
    caster->closest_hits(packet);
    EXPECT_EQ(packet.triangle[0], reversed ? 1u : 0u);
  }
}

// Every ray aims at a diagonal, an edge that two triangles of one square share. All corners and directions
// are whole numbers of binary fractions, so both triangles are met at one distance.
TEST(RayCaster, SharedEdgesGoToTheLowestIndexWhateverElseThereIs) {
  std::vector<glm::vec3> positions = kSquare;
  for (int i = 0; i < 200; ++i) {
    const float x = float(i % 20) - 10.0f, z = -1.0f - float(i / 20);
    positions.insert(positions.end(), {{x, 3, z}, {x + 1, 3, z}, {x, 4, z}});
  }
  for (const bool first : {false, true}) {
    for (const std::uint32_t others : {0u, 7u, 200u}) {
      std::vector<std::array<std::uint32_t, 3>> triangles;
      if (first) triangles = {{0, 2, 3}, {0, 1, 2}};
      for (std::uint32_t i = 0; i < others; ++i) triangles.push_back({4 + 3 * i, 5 + 3 * i, 6 + 3 * i});
      if (!first) triangles.insert(triangles.end(), {{0, 1, 2}, {0, 2, 3}});
      const auto caster = RayCaster::create(positions, triangles);
      ASSERT_TRUE(caster);
      for (int i = 1; i < 64; ++i) {
        RayPacket packet = one_ray({float(i) / 64, float(i) / 64, 1.0f}, {0, 0, -1});
        caster->closest_hits(packet);
        EXPECT_EQ(packet.triangle[0], first ? 0u : others);
        EXPECT_FLOAT_EQ(packet.far[0], 1.0f);
      }
    }
  }
}

TEST(RayCaster, PartlyOverlappingTrianglesGoToTheLowestIndex) {
  const std::vector<glm::vec3> positions{{0, 0, 0},     {4, 0, 1},     {0, 4, 0},
                                         {1, 1, 0.25f}, {9, 1, 2.25f}, {1, 9, 0.25f}};
  for (const bool reversed : {false, true}) {
    std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {3, 5, 4}};
    if (reversed) std::swap(triangles[0], triangles[1]);
    const auto caster = RayCaster::create(positions, triangles);
    ASSERT_TRUE(caster);
    for (int i = 0; i < 50; ++i) {
      // Inside both: x, y > 1, x + y < 4.
      RayPacket packet = one_ray({1.1f + 0.013f * float(i), 1.2f, 7.0f}, {0, 0, -1.3f});
      caster->closest_hits(packet);
      EXPECT_EQ(packet.triangle[0], 0u) << "ray " << i << ", reversed " << reversed;
    }
  }
}

TEST(RayCaster, TheSpreadOfRaysChangesNoAnswer) {
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  const auto caster = RayCaster::create(kSquare, triangles);
  ASSERT_TRUE(caster);
  for (const RaySpread spread : {RaySpread::wide, RaySpread::narrow}) {
    RayPacket packet = one_ray({0.5f, 0.5f, 1.0f}, {0, 0, -1});
    packet.far.fill(std::numeric_limits<float>::infinity());
    packet.far[7] = -1.0f;
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
      packet.origin_x[lane] = 0.3f + 0.1f * float(lane), packet.origin_y[lane] = 0.55f;
      packet.origin_z[lane] = 1.0f;
    }
    caster->closest_hits(packet, spread);
    // Below the diagonal x = y lies triangle 0; beyond x = 1 nothing.
    const std::array<std::uint32_t, 8> expected{1, 1, 1, 0, 0, 0, 0, kNoTriangle};
    EXPECT_EQ(packet.triangle, expected);
  }
}

TEST(RayCaster, OccludedLooksBetweenThePointsOnly) {
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  const auto caster = RayCaster::create(kSquare, triangles);
  ASSERT_TRUE(caster);
  EXPECT_TRUE(caster->occluded({0.5f, 0.5f, 1.0f}, {0.5f, 0.5f, -1.0f}));
  EXPECT_FALSE(caster->occluded({0.5f, 0.5f, 1.0f}, {0.5f, 0.5f, 0.5f}));
  EXPECT_FALSE(caster->occluded({0.5f, 0.5f, -1.0f}, {0.5f, 0.5f, -3.0f}));
}

TEST(RayCaster, AnEmptySceneIsNoError) {
  const auto caster = RayCaster::create({}, {});
  ASSERT_TRUE(caster);
  RayPacket packet = one_ray({0, 0, 0}, {0, 0, 1});
  caster->closest_hits(packet);
  EXPECT_EQ(packet.triangle[0], kNoTriangle);
}

}  // namespace
}  // namespace relume
