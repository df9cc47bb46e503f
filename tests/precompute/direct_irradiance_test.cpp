// SPDX-License-Identifier: MIT
#include "precompute/direct_irradiance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "precompute/light_samples.h"
#include "precompute/punctual_light.h"
#include "support/quad_model.h"

namespace relume {
namespace {

using test::add_quad;
using test::add_sensor;
using test::box_quads;
using test::Quad;

constexpr double kFour = 4.0 * kPi;

Light point_light(const glm::dvec3& position, const Rgb& intensity = Rgb(100.0, 50.0, 10.0)) {
  Light light;
  light.intensity = intensity;
  light.position = position;
  return light;
}

Light spot_light(const glm::dvec3& position, const glm::dvec3& direction, double inner, double outer) {
  Light light = point_light(position);
  light.type = LightType::spot;
  light.direction = glm::normalize(direction);
  light.inner_cone_angle = inner;
  light.outer_cone_angle = outer;
  return light;
}

Light sun(const glm::dvec3& direction) {
  Light light;
  light.type = LightType::directional;
  light.intensity = Rgb(1000.0, 900.0, 800.0);
  light.direction = glm::normalize(direction);
  return light;
}

/// A floor at y = 0 of side 2 `half` about the origin of x and z, facing up.
Quad floor_quad(double half) {
  return {{-half, 0, -half}, {0, 0, 2 * half}, {2 * half, 0, 0}};
}

DirectIrradiance light(const Model& model, const std::vector<Light>& lights, std::uint32_t threads = 0) {
  const auto result = direct_irradiance(model, lights, threads);
  EXPECT_TRUE(result);
  return result.value_or(DirectIrradiance{});
}

/// Sum of area x irradiance over all clusters, red.
double flux(const Model& model, const DirectIrradiance& direct) {
  double sum = 0.0;
  for (std::size_t c = 0; c < direct.clusters.size(); ++c) {
    sum += model.systems[0].clusters[c].area * direct.clusters[c].x;
  }
  return sum;
}

Model room(const glm::dvec3& lower, const glm::dvec3& upper, std::uint32_t cells) {
  Model model;
  for (const Quad& quad : box_quads(lower, upper, /*inward=*/true)) add_quad(model, quad, cells);
  return model;
}

TEST(SolidAngle, OfKnownTriangles) {
  // One octant of the sphere.
  EXPECT_NEAR(solid_angle({0, 0, 0}, {{{1, 0, 0}, {0, 5, 0}, {0, 0, 0.1}}}), kPi / 2.0, 1e-14);
  // In its plane, outside and inside.
  EXPECT_EQ(solid_angle({3, 0, 0}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}}), 0.0);
  EXPECT_EQ(solid_angle({0.25, 0.25, 0}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}}), 0.0);
  // Just above it: nearly a half space.
  EXPECT_NEAR(solid_angle({0.25, 0.25, 1e-9}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}}), 2.0 * kPi, 1e-7);
}

TEST(DirectIrradiance, OfSensorsOverAPlaneIsTheClosedForm) {
  Model model;
  add_quad(model, floor_quad(5.0), 4);
  const std::vector<glm::dvec3> points{{0, 0, 0}, {1.5, 0, -0.5}, {-3, 0, 4}, {2, 0.7, 1}};
  for (const glm::dvec3& point : points) add_sensor(model, point, {0, 1, 0});
  const glm::dvec3 lamp(0.5, 2.0, -1.0);
  Light limited = point_light(lamp);
  limited.range = 5.0;
  const std::vector<Light> lights{point_light(lamp), limited, spot_light(lamp, {0, -1, 0}, 0.2, 0.9),
                                  sun({0.3, -1, 0.2})};
  const std::size_t lumels = model.systems[0].lumels.size();
  for (std::size_t s = 0; s < points.size(); ++s) {
    const glm::dvec3 way = lamp - points[s];
    const double d = std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
    const double point = way.y / (d * d * d);
    const double range = std::max(0.0, 1.0 - std::pow(d / 5.0, 4.0));
    const double cone = std::clamp((way.y / d - std::cos(0.9)) / (std::cos(0.2) - std::cos(0.9)), 0.0, 1.0);
    const std::vector<double> expected{100.0 * point, 100.0 * point * range, 100.0 * point * cone * cone,
                                       1000.0 / std::sqrt(1.0 + 0.09 + 0.04)};
    for (std::size_t l = 0; l < lights.size(); ++l) {
      const Rgb found = light(model, {lights[l]}).gather[lumels + s];
      // A sensor on the floor is lifted by 2^-18 of the largest coordinate.
      EXPECT_NEAR(found.x, expected[l], 1e-4 * expected[l]) << "sensor " << s << ", light " << l;
    }
    EXPECT_NEAR(light(model, lights).gather[lumels + s].x,
                expected[0] + expected[1] + expected[2] + expected[3], 1e-1);
  }
}

TEST(DirectIrradiance, OfASquareUnderALampIsItsSolidAngle) {
  for (const double height : {3.0, 0.5, 0.01, 1e-4}) {
    Model model;
    add_quad(model, floor_quad(1.0), 8);
    const DirectIrradiance direct = light(model, {point_light({0, height, 0})});
    // A square of half side a seen from height h above its middle: 4 atan(a^2 / (h sqrt(2 a^2 + h^2))).
    const double omega = 4.0 * std::atan(1.0 / (height * std::sqrt(2.0 + height * height)));
    // Areas are stored in 32 bits.
    EXPECT_NEAR(direct.clusters[0].x, 100.0 * omega / 4.0, 1e-6 * 100.0 * omega) << height;
    EXPECT_NEAR(direct.clusters[0].y, 50.0 * omega / 4.0, 1e-6 * 50.0 * omega) << height;
  }
}

TEST(DirectIrradiance, LumelsFollowThePointFormula) {
  Model model;
  add_quad(model, floor_quad(2.0), 64);
  const DirectIrradiance direct = light(model, {point_light({0.3, 1.0, 0.2})});
  for (const std::size_t lumel : {0u, 2000u, 2080u, 4095u}) {
    const SurfaceElement& element = model.systems[0].elements[lumel];
    const glm::dvec3 way = glm::dvec3(0.3, 1.0, 0.2) - glm::dvec3(element.position);
    const double squared = glm::dot(way, way);
    // The mean over a lumel of 1/16 m differs from its middle in second order: (0.06)^2.
    const double expected = 100.0 * way.y / std::pow(squared, 1.5);
    EXPECT_NEAR(direct.gather[lumel].x, expected, 5e-3 * expected);
  }
}

TEST(DirectIrradiance, AClosedRoomReceivesAllOfALamp) {
  const Model model = room({0, 0, 0}, {4, 2.5, 3}, 8);
  ASSERT_EQ(model.systems[0].clusters.size(), 6u);
  for (const glm::dvec3& lamp : {glm::dvec3(2, 1.25, 1.5), glm::dvec3(0.3, 2.2, 2.9), glm::dvec3(1, 2.49, 1),
                                 glm::dvec3(3.999, 0.001, 0.001)}) {
    const DirectIrradiance direct = light(model, {point_light(lamp)});
    // Solid angles are exact; what is lost are shadow rays that graze an edge of the room.
    EXPECT_NEAR(flux(model, direct), kFour * 100.0, 1e-3 * kFour * 100.0) << lamp.x;
  }
}

TEST(DirectIrradiance, ALampOnASurfaceGivesHalfAndStaysBounded) {
  const Model model = room({0, 0, 0}, {4, 2.5, 3}, 8);
  const DirectIrradiance direct = light(model, {point_light({1.3, 2.5, 1.1})});
  EXPECT_NEAR(flux(model, direct), kFour * 50.0, 1e-2 * kFour * 50.0)
      << "into the room, not into the ceiling";
  EXPECT_EQ(direct.clusters[3].x, 0.0) << "the ceiling";
  for (const Rgb& irradiance : direct.gather) EXPECT_TRUE(std::isfinite(irradiance.x));
}

TEST(DirectIrradiance, ARoomWithABoxReceivesAllOfALamp) {
  Model model = room({0, 0, 0}, {4, 2.5, 3}, 24);
  for (const Quad& quad : box_quads({1, 0.2, 1}, {2, 1, 2}, /*inward=*/false)) add_quad(model, quad, 8);
  const DirectIrradiance direct = light(model, {point_light({2.7, 2.1, 0.6})});
  EXPECT_NEAR(flux(model, direct), kFour * 100.0, 0.01 * kFour * 100.0);
}

TEST(DirectIrradiance, ASpotSendsWhatItsConeHolds) {
  const Model model = room({0, 0, 0}, {4, 2.5, 3}, 8);
  // 2 pi times the integral over the cosine c of min(1, (c - cos outer) / width)^2: a third of the width, and
  // all above it. The last cone's difference of cosines is 0.00055, which counts as 0.001.
  for (const auto& [inner, outer] : {std::pair{0.2, 0.6}, {0.0, 1.2}, {0.05, 0.06}}) {
    const double width = std::max(0.001, std::cos(inner) - std::cos(outer));
    const double expected = 2.0 * kPi * (1.0 - std::cos(outer) - width + width / 3.0);
    const DirectIrradiance direct = light(model, {spot_light({1.8, 2.4, 1.4}, {0.3, -1, 0.1}, inner, outer)});
    // Cones are met by random points, at least 64 in each.
    EXPECT_NEAR(flux(model, direct), 100.0 * expected, 0.02 * 100.0 * expected) << outer;
  }
}

TEST(DirectIrradiance, AShadowCoversItsShare) {
  // A blocker over x > 0.3 of a floor from -1 to 1: 0.65 of it see a sun overhead.
  for (const bool facing_up : {true, false}) {
    Model model;
    add_quad(model, floor_quad(1.0), 16);
    Quad blocker{{0.3, 0.5, -2}, {0, 0, 4}, {2, 0, 0}};
    if (!facing_up) std::swap(blocker.edge_s, blocker.edge_t);
    add_quad(model, blocker, 0);
    const DirectIrradiance direct = light(model, {sun({0, -1, 0})});
    // 256 lumels with 18 random points each, 16 of them cut by the edge: 0.5 / sqrt(16 * 18) / 16 of the
    // floor.
    EXPECT_NEAR(direct.clusters[0].x, 650.0, 4.0 * 1000.0 * 0.5 / std::sqrt(16.0 * 18.0) / 16.0);
    EXPECT_NEAR(direct.gather[0].x, 1000.0, 1e-3);
    EXPECT_EQ(direct.gather[255].x, 0.0);
  }
}

TEST(DirectIrradiance, AShadowOfALampIsWhereGeometryPutsIt) {
  // Lamp at height 2; the blocker's edge at height 1, x = 0.25 puts the shadow's edge at x = 0.5. Sensors on
  // both sides of it.
  Model model;
  add_quad(model, floor_quad(1.0), 4);
  add_quad(model, {{0.25, 1, -2}, {0, 0, 4}, {2, 0, 0}}, 0);
  add_sensor(model, {0.499, 0, 0.1}, {0, 1, 0});
  add_sensor(model, {0.501, 0, 0.1}, {0, 1, 0});
  const DirectIrradiance direct = light(model, {point_light({0, 2, 0})});
  EXPECT_GT(direct.gather[16].x, 20.0);
  EXPECT_EQ(direct.gather[17].x, 0.0);
}

TEST(DirectIrradiance, WhatAPaneDoesNotStopArrives) {
  // Two panes over the floor, of which a quarter and a half stop light; the second ends at x = 0.25,
  // height 1.
  Model model;
  add_quad(model, floor_quad(1.0), 4);
  add_quad(model, {{-3, 1.5, -3}, {0, 0, 6}, {6, 0, 0}}, 0);
  add_quad(model, {{0.25, 1, -2}, {0, 0, 4}, {2, 0, 0}}, 0);
  Opacity& opacity = model.occluders.opacity;
  for (std::uint32_t t = 2; t < 6; ++t) {
    const float alpha = t < 4 ? 0.25f : 0.5f;
    opacity.triangles.push_back(
        {t, 0, {glm::vec3(0, 0, alpha), glm::vec3(0, 0, alpha), glm::vec3(0, 0, alpha)}});
  }
  opacity.maps.emplace_back();
  const glm::dvec3 lamp(0, 2, 0);
  for (const double x : {0.499, 0.501}) add_sensor(model, {x, 0, 0.1}, {0, 1, 0});
  const DirectIrradiance direct = light(model, {point_light(lamp)});
  for (std::size_t s = 0; s < 2; ++s) {
    const glm::dvec3 way = lamp - model.systems[0].sensors[s].position;
    const double unblocked = 100.0 * way.y / std::pow(glm::dot(way, way), 1.5);
    const double expected = unblocked * (s == 0 ? 0.75 : 0.375);
    EXPECT_NEAR(direct.gather[16 + s].x, expected, 1e-4 * expected);
  }
}

TEST(DirectIrradiance, EachSideReceivesItsOwn) {
  Model model;
  model.materials = {{"sheet", true, false}};
  add_quad(model, floor_quad(1.0), 4);
  // The same sheet again as its back: elements of the back on the triangles of the front.
  System& system = model.systems[0];
  Cluster back = system.clusters[0];
  back.side = Side::back;
  back.normal = {0, -1, 0};
  back.first_element = 16;
  system.clusters.push_back(back);
  for (std::size_t e = 0; e < 16; ++e) {
    SurfaceElement element = system.elements[e];
    element.normal = {0, -1, 0};
    element.cluster = 1;
    system.elements.push_back(element);
  }
  const DirectIrradiance above = light(model, {sun({0, -1, 0})});
  EXPECT_NEAR(above.clusters[0].x, 1000.0, 1e-3);
  EXPECT_EQ(above.clusters[1].x, 0.0);
  const DirectIrradiance below = light(model, {sun({0, 1, 0})});
  EXPECT_EQ(below.clusters[0].x, 0.0);
  EXPECT_NEAR(below.clusters[1].x, 1000.0, 1e-3);
}

TEST(DirectIrradiance, PiecesThatReachThroughAWallTakeNoLightFromBehindIt) {
  // One element from x = -1 to 1; a wall at x = 0.25, the element's middle at x = 0. The lamp is beyond the
  // wall.
  Model model;
  add_quad(model, floor_quad(1.0), 1);
  add_quad(model, {{0.25, -1, -2}, {0, 4, 0}, {0, 0, 4}}, 0);
  ASSERT_TRUE(add_light_samples(model));
  EXPECT_EQ(light(model, {point_light({0.6, 1, 0})}).clusters[0].x, 0.0);
  // And from a lamp on its own side, the mean is over what belongs to it: a sun is not thinned by the part
  // behind.
  EXPECT_NEAR(light(model, {sun({0, -1, 0})}).clusters[0].x, 1000.0, 1e-3);
}

TEST(DirectIrradiance, IsTheSameForAnyNumberOfThreads) {
  Model model = room({0, 0, 0}, {4, 2.5, 3}, 8);
  for (const Quad& quad : box_quads({1, 0.2, 1}, {2, 1, 2}, /*inward=*/false)) add_quad(model, quad, 8);
  const std::vector<Light> lights{point_light({2.7, 2.1, 0.6}), spot_light({1, 2, 1}, {0, -1, 0}, 0.1, 0.5)};
  const DirectIrradiance one = light(model, lights, 1);
  const DirectIrradiance two = light(model, lights, 2);
  EXPECT_EQ(one.clusters, two.clusters);
  EXPECT_EQ(one.gather, two.gather);
}

TEST(DirectIrradiance, FollowsTheOriginOfTheModel) {
  Model model;
  model.origin = {10000.0, 200.0, -5000.0};
  Quad floor = floor_quad(1.0);
  floor.corner += model.origin;
  add_quad(model, floor, 8);
  add_sensor(model, model.origin + glm::dvec3(0.5, 0, 0.5), {0, 1, 0});
  const DirectIrradiance direct = light(model, {point_light(model.origin + glm::dvec3(0, 0.5, 0))});
  const double omega = 4.0 * std::atan(1.0 / (0.5 * std::sqrt(2.25)));
  EXPECT_NEAR(direct.clusters[0].x, 25.0 * omega, 1e-4);
  EXPECT_NEAR(direct.gather[64].x, 100.0 * 0.5 / std::pow(0.75, 1.5), 1e-2);
}

TEST(DirectIrradiance, WithoutLightsIsDark) {
  Model model = room({0, 0, 0}, {1, 1, 1}, 2);
  add_sensor(model, {0.5, 0.5, 0.5}, {0, 1, 0});
  const DirectIrradiance direct = light(model, {});
  ASSERT_EQ(direct.clusters.size(), 6u);
  ASSERT_EQ(direct.gather.size(), 25u);
  for (const Rgb& irradiance : direct.gather) EXPECT_EQ(irradiance, Rgb(0.0));
}

}  // namespace
}  // namespace relume
