// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "precompute/direct_irradiance.h"
#include "support/scene_builder.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

using P = glm::dvec3;

PrecomputeOptions options(double cluster_size, double texel_size) {
  PrecomputeOptions result;
  result.cluster_size = cluster_size;
  result.texel_size = texel_size;
  result.quality = 8;
  result.sensor_quality = 8;
  return result;
}

DirectIrradiance lit(const Model& model, const std::vector<Light>& lights) {
  auto direct = direct_irradiance(model, lights);
  if (!direct) throw std::runtime_error(direct.error().message);
  return std::move(*direct);
}

Light point_light(const P& position, double intensity) {
  Light light;
  light.position = position;
  light.intensity = Rgb(intensity, 2.0 * intensity, 0.0);
  return light;
}

/// A floor of 8 x 8 m about the origin with sensors on it every 0.9 m, on the surface as a user would place
/// them.
struct Plane {
  std::vector<SensorPoint> sensors;
  Model model;
};
Plane plane() {
  Plane result;
  SceneBuilder b;
  b.add_quad("floor", b.material("floor", Rgb(0.5)), {P(-4, 0, -4), P(-4, 0, 4), P(4, 0, 4), P(4, 0, -4)});
  for (double x = -3.6; x < 3.7; x += 0.9) {
    for (double z = -3.6; z < 3.7; z += 0.9) result.sensors.push_back({"s", {x, 0.0, z}, {0, 1, 0}});
  }
  PrecomputeOptions chosen = options(1.0, 0.5);
  chosen.sensors = result.sensors;
  result.model = precompute_or_throw(b.scene(), chosen);
  return result;
}

TEST(DirectLight, PointOverAPlane) {
  const Plane p = plane();
  const auto at = at_sensors(p.model, lit(p.model, {point_light({0.3, 1.5, -0.2}, 100.0)}).gather);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const P way = P(0.3, 1.5, -0.2) - p.sensors[i].position;
    const double expected = 100.0 * way.y / std::pow(glm::dot(way, way), 1.5);
    EXPECT_NEAR(at[i].r, expected, 1e-3 * expected);
    EXPECT_NEAR(at[i].g, 2.0 * expected, 2e-3 * expected);
    EXPECT_EQ(at[i].b, 0.0);
  }
}

TEST(DirectLight, SpotOverAPlane) {
  const Plane p = plane();
  Light spot = point_light({0.0, 2.0, 0.0}, 100.0);
  spot.type = LightType::spot;
  spot.direction = glm::normalize(P(0.5, -1.0, 0.25));
  spot.inner_cone_angle = 0.3;
  spot.outer_cone_angle = 0.7;
  const auto at = at_sensors(p.model, lit(p.model, {spot}).gather);
  int in_penumbra = 0, outside = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const P way = spot.position - p.sensors[i].position;
    const double angle = std::acos(-glm::dot(glm::normalize(way), spot.direction));
    const double a =
        std::clamp((std::cos(angle) - std::cos(0.7)) / (std::cos(0.3) - std::cos(0.7)), 0.0, 1.0);
    const double expected = 100.0 * a * a * way.y / std::pow(glm::dot(way, way), 1.5);
    in_penumbra += a > 0.0 && a < 1.0 ? 1 : 0;
    outside += a == 0.0 ? 1 : 0;
    EXPECT_NEAR(at[i].r, expected, 1e-3 * expected);
  }
  EXPECT_GT(in_penumbra, 5);
  EXPECT_GT(outside, 5);
}

TEST(DirectLight, DirectionalOverAPlane) {
  const Plane p = plane();
  Light sun;
  sun.type = LightType::directional;
  sun.direction = glm::normalize(P(0.3, -0.5, 0.1));
  sun.intensity = Rgb(50000.0);
  const double expected = 50000.0 * 0.5 / std::sqrt(0.35);
  for (const Rgb& value : at_sensors(p.model, lit(p.model, {sun}).gather))
    EXPECT_NEAR(value.r, expected, 1e-3 * expected);
  sun.direction = -sun.direction;
  for (const Rgb& value : at_sensors(p.model, lit(p.model, {sun}).gather)) EXPECT_EQ(value.r, 0.0);
}

/// Sum of area x irradiance over all clusters, and over the elements of all lumels, in the red channel.
struct Flux {
  double clusters = 0.0, lumels = 0.0;
};
Flux flux_of(const Model& model, const DirectIrradiance& direct) {
  Flux flux;
  const auto clusters = cluster_offsets(model), rows = gather_offsets(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    for (std::size_t c = 0; c < system.clusters.size(); ++c)
      flux.clusters += double(system.clusters[c].area) * direct.clusters[clusters[s] + c].r;
    for (std::size_t l = 0; l < system.lumels.size(); ++l)
      flux.lumels += double(system.elements[system.lumels[l].element].area) * direct.gather[rows[s] + l].r;
  }
  return flux;
}

/// 4 pi x intensity arrives in a closed room wherever the light is, to 1 %.
void expect_all_flux(const Scene& scene, const P& light, double cluster_size) {
  const Model model = precompute_or_throw(scene, options(cluster_size, cluster_size / 2));
  const Flux flux = flux_of(model, lit(model, {point_light(light, 7.0)}));
  const double expected = 4.0 * kPi * 7.0;
  EXPECT_NEAR(flux.clusters, expected, 0.01 * expected) << light.x << ' ' << light.y << ' ' << light.z;
  EXPECT_NEAR(flux.lumels, expected, 0.01 * expected) << light.x << ' ' << light.y << ' ' << light.z;
}

TEST(DirectLight, AllFluxOfAPointLightArrivesInAClosedRoom) {
  for (const P& at : {P(2.1, 1.3, 1.9), P(0.4, 2.2, 0.3), P(4.9, 0.1, 3.9)}) {
    expect_all_flux(box_room({}), at, 0.5);
    expect_all_flux(box_room({}), at, 2.0);
  }
  expect_all_flux(l_room({}), {4.5, 2.0, 0.4}, 0.5);
  expect_all_flux(sphere_room(24, 2.0, {}, {}), {0.3, 0.5, -0.2}, 0.25);
}

TEST(DirectLight, AllFluxArrivesFromALightVeryNearAWall) {
  // 1 cm and 1 mm from a wall, over the middle, a border and a corner of its clusters.
  for (const double distance : {0.01, 0.001}) {
    for (const P& at : {P(distance, 1.13, 1.87), P(distance, 1.0, 2.0), P(2.37, 2.5 - distance, 2.0)})
      expect_all_flux(box_room({}), at, 0.5);
  }
}

TEST(DirectLight, NearALightTheIrradianceOfALumelStaysBelowItsShareOfTheFlux) {
  const Model model = precompute_or_throw(box_room({}), options(0.5, 0.25));
  const DirectIrradiance direct = lit(model, {point_light({0.01, 1.13, 1.87}, 7.0)});
  // Half of all directions meet the wall, most of them in one lumel of 1/16 m2.
  const double bound = 2.0 * kPi * 7.0 / 0.0625;
  double largest = 0.0;
  for (const Rgb& value : direct.gather) largest = std::max(largest, value.r);
  EXPECT_LE(largest, bound);
  EXPECT_GE(largest, 0.8 * bound);
}

TEST(DirectLight, FewRaysLoseNoFluxAndPassNoWall) {
  // A patch that is a whole piece still has its exact solid angle, so all flux arrives. Floor, ceiling and
  // side walls of the sealed rooms run on under the wall between them.
  const Model model = precompute_or_throw(box_room({}), options(0.5, 0.25));
  const auto direct = direct_irradiance(model, std::vector{point_light({2.1, 1.3, 1.9}, 7.0)}, 0, 1.0);
  ASSERT_TRUE(direct) << direct.error().message;
  const double expected = 4.0 * kPi * 7.0;
  EXPECT_NEAR(flux_of(model, *direct).lumels, expected, 1e-4 * expected);

  const Model sealed = precompute_or_throw(sealed_rooms(0.05), options(0.6, 0.3));
  const auto one_room = direct_irradiance(sealed, std::vector{point_light({1.0, 1.0, 1.0}, 7.0)}, 0, 1.0);
  ASSERT_TRUE(one_room) << one_room.error().message;
  std::size_t dark = 0;
  for (std::size_t l = 0; l < sealed.systems.at(0).lumels.size(); ++l) {
    const System& system = sealed.systems[0];
    if (system.elements[system.lumels[l].element].position.x + sealed.origin.x < 2.05) continue;
    EXPECT_EQ(one_room->gather[l], Rgb(0.0)) << l;
    ++dark;
  }
  EXPECT_GT(dark, 200u);
}

TEST(DirectLight, FurnitureTakesItsShareOfTheFlux) {
  // The outer surfaces of a furnished room are closed as well: only clusters in the dark get nothing.
  expect_all_flux(furnished_room({}), {2.0, 2.0, 1.5}, 0.2);
}

TEST(DirectLight, ShadowsHaveTheirClosedFormEdge) {
  // A roof of 2 x 2 m at 1 m above the plane, a light 3 m above it: the shadow is a square of 3 x 3 m.
  SceneBuilder b;
  b.add_quad("floor", b.material("floor", Rgb(0.5)), {P(-4, 0, -4), P(-4, 0, 4), P(4, 0, 4), P(4, 0, -4)});
  b.add_quad("roof", b.material("roof", Rgb(0.5)), {P(-1, 1, -1), P(1, 1, -1), P(1, 1, 1), P(-1, 1, 1)});
  const Model model = precompute_or_throw(b.scene(), options(0.2, 0.1));
  const DirectIrradiance direct = lit(model, {point_light({0, 3, 0}, 10.0)});
  double shadowed = 0.0;
  const System& system = model.systems.at(0);
  for (std::size_t l = 0; l < system.lumels.size(); ++l) {
    const SurfaceElement& element = system.elements[system.lumels[l].element];
    if (element.position.y > 0.5f) continue;
    const double way2 = double(element.position.x) * element.position.x +
                        double(element.position.z) * element.position.z + 9.0;
    const double unshadowed = 10.0 * 3.0 / std::pow(way2, 1.5);
    shadowed += element.area * (1.0 - direct.gather[l].r / unshadowed);
  }
  // Its border is 12 m long and runs through lumels of 0.1 m: their visibility samples may misplace it by a
  // tenth of a lumel on average.
  EXPECT_NEAR(shadowed, 9.0, 12.0 * 0.01);
}

}  // namespace
}  // namespace relume::test
