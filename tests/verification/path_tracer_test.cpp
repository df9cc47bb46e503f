// SPDX-License-Identifier: MIT
//
// The witness is examined first: closed forms, a furnace, and the shared truth, which another program
// computed.
#include "verification/path_tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "scene/load_scene.h"
#include "support/scene_builder.h"
#include "verification/closed_forms.h"
#include "verification/rooms.h"
#include "verification/truth_data.h"

namespace relume::test {
namespace {

using P = glm::dvec3;

/// A lamp of 1 x 0.5 m, 1.2 m above the floor point (0, 0, 0), its corner straight above it; exitance 1
/// lm/m2.
const std::array<P, 4> kLamp{P(0, 1.2, 0), P(1, 1.2, 0), P(1, 1.2, 0.5), P(0, 1.2, 0.5)};
const SurfacePoint3 kBelow{{0, 0, 0}, {0, 1, 0}};

Scene lamp_alone(bool double_sided) {
  SceneBuilder b;
  b.add_quad("lamp", b.material("lamp", Rgb(0.0), Rgb(1.0 / kPi), double_sided), kLamp);
  return b.scene();
}

void expect_within_errors(const Estimate& estimate, double expected) {
  for (int c = 0; c < 3; ++c) {
    // 4 standard errors from 16 batches; the floor allows for an estimator without any scatter.
    EXPECT_NEAR(estimate.mean[c], expected, 4.0 * estimate.standard_error[c] + 1e-9);
    EXPECT_LT(estimate.standard_error[c], 0.01 * expected + 1e-12);
  }
}

TEST(ClosedForms, PolygonFormulaGivesTheCatalogueNumber) {
  EXPECT_NEAR(element_to_polygon(kBelow.position, kBelow.normal, kLamp),
              element_to_parallel_rectangle(1.0, 0.5, 1.2), 1e-14);
  // Howell B-3 at a = b = c: (2 / sqrt 2) atan(1 / sqrt 2) / (2 pi).
  EXPECT_NEAR(element_to_parallel_rectangle(1.0, 1.0, 1.0), 0.13853160599489298, 1e-15);
}

TEST(PathTracer, LampLightsAnElementByItsFormFactor) {
  const double expected = element_to_parallel_rectangle(1.0, 0.5, 1.2);
  expect_within_errors(PathTracer(lamp_alone(false), {}).indirect(kBelow, {16, 1024, 3}), expected);
  expect_within_errors(PathTracer(lamp_alone(true), {}).indirect(kBelow, {16, 1024, 3}), expected);
}

TEST(PathTracer, OnlyDoubleSidedLampsShineUpwards) {
  const SurfacePoint3 above{{0, 2.4, 0}, {0, -1, 0}};
  const double expected = element_to_parallel_rectangle(1.0, 0.5, 1.2);
  expect_within_errors(PathTracer(lamp_alone(true), {}).indirect(above, {16, 1024, 3}), expected);
  EXPECT_EQ(PathTracer(lamp_alone(false), {}).indirect(above, {16, 1024, 3}).mean, Rgb(0.0));
}

TEST(PathTracer, BacksAreOpaqueAndBlack) {
  // A white sheet, its back to both the lamp and the floor point, hides the whole lamp.
  SceneBuilder b;
  b.add_quad("lamp", b.material("lamp", Rgb(0.0), Rgb(1.0 / kPi)), kLamp);
  b.add_quad("sheet", b.material("white", Rgb(0.9)),
             {P(-9, 0.6, -9), P(-9, 0.6, 9), P(9, 0.6, 9), P(9, 0.6, -9)});
  EXPECT_EQ(PathTracer(b.scene(), {}).indirect(kBelow, {4, 1024, 3}).mean, Rgb(0.0));
}

TEST(PathTracer, SkyAboveAnOpenFloorGivesPiTimesItsRadiance) {
  const PathTracer tracer(lamp_alone(false), {}, [](const P&) { return Rgb(2.0); });
  const double hidden = element_to_parallel_rectangle(1.0, 0.5, 1.2);
  expect_within_errors(tracer.indirect(kBelow, {16, 1024, 3}), 2.0 * kPi * (1.0 - hidden) + hidden);
}

TEST(PathTracer, FurnaceGivesTheGeometricSeries) {
  const Scene room = l_room({0.8, 1.0});
  const PathTracer tracer(room, {});
  // I = M / (1 - rho) everywhere.
  expect_within_errors(tracer.indirect({{0.3, 0.001, 0.4}, {0, 1, 0}}, {16, 4096, 1}), kPi / 0.2);
  expect_within_errors(tracer.indirect({{2.499, 1.7, 3.0}, {-1, 0, 0}}, {16, 4096, 2}), kPi / 0.2);
}

TEST(PathTracer, PunctualLightsFollowTheirClosedForms) {
  Light point;
  point.intensity = Rgb(10.0);
  point.position = {0.0, 2.0, 1.5};
  Light sun;
  sun.type = LightType::directional;
  sun.intensity = Rgb(3.0);
  sun.direction = {0.6, -0.8, 0.0};
  // 10 cd x cos / d2, with d = 2.5 m and cos = 2 / 2.5; the sun at cos = 0.8.
  EXPECT_NEAR(PathTracer(lamp_alone(false), {point, sun}).direct(kBelow).r, 10.0 * 0.8 / 6.25 + 3.0 * 0.8,
              1e-12);
  // A lamp in the way.
  point.position = {0.6, 2.4, 0.5};
  EXPECT_EQ(PathTracer(lamp_alone(false), {point}).direct(kBelow), Rgb(0.0));
}

/// z of every channel of every `stride`th sensor: mean and root mean square.
void expect_truth(const std::string& room, const std::string& sensors_csv, std::size_t stride) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << "the shared truth set is not here";
  const auto truth_folder = *shared / "truth";
  const auto scene = load_scene(truth_folder / (room + ".glb"));
  ASSERT_TRUE(scene) << scene.error().message;
  const RoomTruth truth = read_room_truth(truth_folder / (room + ".json"));
  const auto sensors = read_sensors(truth_folder / sensors_csv);
  const PathTracer tracer(*scene, scene->lights);
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < sensors.size(); i += stride) {
    const SurfacePoint3 at{sensors[i].position, sensors[i].normal};
    const Estimate estimate = tracer.indirect(at, {16, 1024, i});
    for (int c = 0; c < 3; ++c) {
      const double error = std::hypot(estimate.standard_error[c], truth.standard_error[i][c]);
      const double z = (estimate.mean[c] - truth.indirect[i][c]) / error;
      sum += z, squares += z * z, count += 1.0;
      EXPECT_NEAR(tracer.direct(at)[c], truth.punctual[i][c], 1e-4 * (1.0 + truth.punctual[i][c]));
    }
  }
  // Channels are correlated, so count / 3 independent numbers at least: 4 standard errors of their mean. The
  // root mean square of such t-like numbers is near 1.07; 1.4 would be off by more than 4 of its own standard
  // errors.
  EXPECT_LT(std::abs(sum / count), 4.0 / std::sqrt(count / 3.0));
  EXPECT_LT(std::sqrt(squares / count), 1.4);
}

TEST(PathTracer, AgreesWithTheTruthOfTheFurnishedRoom) {
  expect_truth("room_B", "room_sensors.csv", 7);
}

TEST(PathTracer, AgreesWithTheTruthOfTwoRooms) {
  expect_truth("two_rooms_A", "two_rooms_sensors.csv", 7);
}

}  // namespace
}  // namespace relume::test
