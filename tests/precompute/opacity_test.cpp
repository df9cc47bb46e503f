// SPDX-License-Identifier: MIT
#include "precompute/opacity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "precompute/ray_caster.h"

namespace relume {
namespace {

const std::vector<glm::vec3> kSquares{{0, 0, 0},  {1, 0, 0},  {1, 1, 0},  {0, 1, 0},
                                      {0, 0, -1}, {1, 0, -1}, {1, 1, -1}, {0, 1, -1}};
using Triangles = std::vector<std::array<std::uint32_t, 3>>;
/// The lower right half of the square, once at z = 0 and once at z = -1.
const Triangles kTwo{{0, 1, 2}, {4, 5, 6}};

/// A blend without an image over triangle `triangle`.
void add_pane(Opacity& opacity, std::uint32_t triangle, float alpha) {
  OpacityMap map;
  opacity.triangles.push_back({triangle, std::uint32_t(opacity.maps.size()), {}});
  for (glm::vec3& corner : opacity.triangles.back().corners) corner.z = alpha;
  opacity.maps.push_back(map);
}

/// A mask of 2 x 2 texels over triangle `triangle`, whose s and t are x and y:
///
///     t
///     |  255    0
///     |    0  255
///     +----------- s
void add_checkers(Opacity& opacity, std::uint32_t triangle) {
  OpacityMap map{OpacityRule::mask,
                 0.5f,
                 1.0f,
                 2,
                 2,
                 WrapMode::repeat,
                 WrapMode::repeat,
                 std::uint32_t(opacity.texels.size())};
  opacity.texels.insert(opacity.texels.end(), {0, 255, 255, 0});
  opacity.triangles.push_back({triangle, std::uint32_t(opacity.maps.size()), {}});
  opacity.triangles.back().corners = {glm::vec3(0, 0, 1), glm::vec3(1, 0, 1), glm::vec3(1, 1, 1)};
  opacity.maps.push_back(map);
}

RayPacket down(float x, float y) {
  RayPacket packet{};
  packet.far.fill(-1.0f);
  packet.origin_x[0] = x, packet.origin_y[0] = y, packet.origin_z[0] = 1.0f;
  packet.direction_z[0] = -1.0f;
  packet.far[0] = std::numeric_limits<float>::infinity();
  return packet;
}

std::uint32_t met(const RayCaster& caster, float x, float y) {
  RayPacket packet = down(x, y);
  caster.closest_hits(packet);
  return packet.triangle[0];
}

RayCaster caster_of(const Triangles& triangles, const Opacity& opacity) {
  return std::move(RayCaster::create(kSquares, triangles, opacity)).value();
}

TEST(Opacity, OfAPartIsItsSolidShare) {
  Opacity opacity;
  add_checkers(opacity, 0);
  add_pane(opacity, 1, 0.25f);
  const TriangleOpacity lookup(opacity, kSquares, kTwo);
  // Below the diagonal lie the texel at s > 1/2, t < 1/2, which is solid, and half of each of two holes: 1/4
  // of 1/2.
  EXPECT_NEAR(lookup.mean(0, {glm::vec2{0, 0}, {1, 0}, {0, 1}}), 0.5, 1e-12);
  // (1/2, 0) (1, 0) (1, 1/2): inside the solid texel. In (u, v) with x = u + v, y = v.
  EXPECT_NEAR(lookup.mean(0, {glm::vec2{0.5f, 0}, {1, 0}, {0.5f, 0.5f}}), 1.0, 1e-12);
  // (0, 0) (1/2, 0) (1/2, 1/2): a hole.
  EXPECT_NEAR(lookup.mean(0, {glm::vec2{0, 0}, {0.5f, 0}, {0, 0.5f}}), 0.0, 1e-12);
  EXPECT_EQ(lookup.mean(1, {glm::vec2{0, 0}, {1, 0}, {0, 1}}), 0.25);
}

TEST(Opacity, FarOutTextureCoordinatesRepeatTheImage) {
  Opacity opacity;
  add_checkers(opacity, 0);
  for (glm::vec3& corner : opacity.triangles[0].corners) corner.x -= 0x1p20f, corner.y += 0x1p20f;
  EXPECT_NEAR(TriangleOpacity(opacity, kSquares, kTwo).mean(0, {glm::vec2{0, 0}, {1, 0}, {0, 1}}), 0.5,
              1e-12);
  for (glm::vec3& corner : opacity.triangles[0].corners) corner.x *= 1e9f;
  const double mean = TriangleOpacity(opacity, kSquares, kTwo).mean(0, {glm::vec2{0, 0}, {1, 0}, {0, 1}});
  EXPECT_TRUE(mean >= 0.0 && mean <= 1.0);
}

TEST(Opacity, AMaskIsMetWhereItIsSolid) {
  Opacity opacity;
  add_checkers(opacity, 0);
  const RayCaster caster = caster_of(kTwo, opacity);
  EXPECT_EQ(met(caster, 0.75f, 0.25f), 0u);
  EXPECT_EQ(met(caster, 0.4f, 0.2f), 1u) << "through a hole";
  EXPECT_EQ(caster.transmittance({0.75f, 0.25f, 1}, {0.75f, 0.25f, -0.5f}), 0.0f);
  EXPECT_EQ(caster.transmittance({0.4f, 0.2f, 1}, {0.4f, 0.2f, -0.5f}), 1.0f);
}

TEST(Opacity, CoincidentFacesGoToTheLowestThatIsSolidThere) {
  // The masked face before and after an opaque one with the same corners.
  for (const std::uint32_t masked : {0u, 1u}) {
    Opacity opacity;
    add_checkers(opacity, masked);
    const RayCaster caster = caster_of({{0, 1, 2}, {0, 1, 2}}, opacity);
    EXPECT_EQ(met(caster, 0.75f, 0.25f), 0u);
    EXPECT_EQ(met(caster, 0.4f, 0.2f), 1u - masked);
  }
}

TEST(Opacity, ABlendStopsItsShareOfRays) {
  Opacity opacity;
  add_pane(opacity, 0, 0.25f);
  const RayCaster caster = caster_of(kTwo, opacity);
  int stopped = 0, hidden = 0;
  constexpr int kRays = 1 << 16;
  for (int i = 0; i < kRays; ++i) {
    const float x = 0.5f + 0.4f * float(i % 256) / 256.0f, y = 0.4f * float(i / 256) / 256.0f;
    const std::uint32_t triangle = met(caster, x, y);
    ASSERT_LE(triangle, 1u);
    stopped += triangle == 0 ? 1 : 0;
    RayPacket packet = down(x, y);
    packet.far[0] = 1.5f;
    const std::uint32_t is_hidden = caster.occluded(packet);
    EXPECT_EQ(is_hidden, triangle == 0 ? 1u : 0u) << "the coin of a ray is one, whatever the question";
    hidden += int(is_hidden);
  }
  const double error = std::sqrt(0.25 * 0.75 / kRays);
  EXPECT_NEAR(double(stopped) / kRays, 0.25, 4.0 * error);
}

TEST(Opacity, TransmittanceIsTheProductOverSheets) {
  Opacity opacity;
  add_pane(opacity, 0, 0.25f);
  add_pane(opacity, 1, 0.5f);
  const glm::vec3 above(0.7f, 0.2f, 1.0f), below(0.7f, 0.2f, -2.0f);
  EXPECT_EQ(caster_of(kTwo, opacity).transmittance(above, below), 0.375f);
  EXPECT_EQ(caster_of({{0, 1, 2}, {4, 5, 6}, {0, 1, 2}}, opacity).transmittance(above, below), 0.0f)
      << "something opaque stops all";
  EXPECT_EQ(caster_of(kTwo, {}).transmittance(above, below), 0.0f);
  EXPECT_EQ(caster_of(kTwo, {}).transmittance(above, {0.7f, 0.2f, 0.5f}), 1.0f);
}

TEST(Opacity, TwoFacesBackToBackAreOneSheet) {
  Opacity opacity;
  add_pane(opacity, 0, 0.25f);
  add_pane(opacity, 1, 0.25f);
  const Triangles back_to_back{{0, 1, 2}, {2, 1, 0}};
  const TriangleOpacity lookup(opacity, kSquares, back_to_back);
  for (std::uint64_t key = 0; key < 1000; ++key)
    EXPECT_EQ(lookup.passes(0, 0.3f, 0.3f, key), lookup.passes(1, 0.3f, 0.3f, key));
  EXPECT_EQ(caster_of(back_to_back, opacity).transmittance({0.7f, 0.2f, 1}, {0.7f, 0.2f, -2}), 0.75f);
}

TEST(Opacity, WhatIsNowhereSolidIsNotThere) {
  Opacity opacity;
  add_pane(opacity, 0, 0.0f);
  const RayCaster caster = caster_of(kTwo, opacity);
  EXPECT_EQ(met(caster, 0.7f, 0.2f), 1u);
  EXPECT_FALSE(caster.occluded({0.7f, 0.2f, 1}, {0.7f, 0.2f, -0.5f}));
  add_pane(opacity, 1, 0.01f);
  EXPECT_TRUE(caster_of(kTwo, opacity).occluded({0.7f, 0.2f, 1}, {0.7f, 0.2f, -1.5f}))
      << "questions about surfaces see the thinnest pane";
}

}  // namespace
}  // namespace relume
