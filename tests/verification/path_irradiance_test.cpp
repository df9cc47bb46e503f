// SPDX-License-Identifier: MIT
//
// The paths that benchmarks measure against, against a furnace, another path tracer, and numbers by chance.
#include "measure/path_irradiance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "measure/room_errors.h"
#include "verification/path_tracer.h"
#include "verification/rooms.h"

namespace relume::test {
namespace {

constexpr std::size_t kSensors = 100;

TEST(PathIrradiance, IsThatOfAFurnace) {
  const auto test = test_scene(box_room({0.5, 0.0}), kSensors);
  ASSERT_TRUE(test) << test.error().message;
  const auto paths = path_irradiance(*test, {1024, {}, false});
  ASSERT_TRUE(paths) << paths.error().message;
  // All glows with 1000 lm/m2, and reflects half.
  double off = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < kSensors; ++i) {
    off += paths->values[0][i].g - 2000.0, noise += paths->noise[0][i] / 3.0;
    EXPECT_LT(paths->noise[0][i], 3.0 * 60.0 * 60.0);
  }
  EXPECT_LT(std::abs(off), 3.0 * std::sqrt(noise));
}

/// Squared differences from the other path tracer, over what noise would make of them: about 1.
double excess(const TestScene& test, const PathIrradiance& paths, std::size_t light) {
  Scene scene = test.scene;
  for (std::uint32_t m = 0; m < scene.materials.size(); ++m) {
    if (m != test.lamp_material || !test.lights[light].lamp) scene.materials[m].emission = Rgb(0.0);
  }
  const PathTracer witness(scene, test.lights[light].lights);
  std::vector<SurfacePoint3> points;
  for (const SensorPoint& sensor : test.sensors)
    points.push_back({sensor.position + 2e-5 * sensor.normal, sensor.normal});
  const auto expected = witness.indirect(points, {16, 256, 1});
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Rgb off = paths.values[light][i] - expected[i].mean, error = expected[i].standard_error;
    const double noise = paths.noise[light][i] + glm::dot(error, error);
    if (off == Rgb(0.0) && noise == 0.0) continue;  // inside of a box
    sum += glm::dot(off, off) / noise, count += 1.0;
  }
  EXPECT_GT(count, 0.8 * double(points.size()));
  return sum / count;
}

TEST(PathIrradiance, AgreesWithAnotherPathTracer) {
  const auto test = test_scene(two_rooms_recoloured(), kSensors);
  ASSERT_TRUE(test) << test.error().message;
  const auto paths = path_irradiance(*test, {4096, {}, false});
  ASSERT_TRUE(paths) << paths.error().message;
  for (std::size_t l = 1; l < test->lights.size(); ++l) {
    const double found = excess(*test, *paths, l);
    EXPECT_GT(found, 0.6) << test->lights[l].name;
    EXPECT_LT(found, 1.5) << test->lights[l].name;
  }
}

TEST(PathIrradiance, OfSomeSensorsIsTheSame) {
  const auto test = test_scene(box_room({0.5, 0.0}), kSensors);
  ASSERT_TRUE(test) << test.error().message;
  const auto all = path_irradiance(*test, {256, {}, false}), some = path_irradiance(*test, {256, {7}, false});
  ASSERT_TRUE(all && some);
  EXPECT_EQ(some->values[2][7], all->values[2][7]);
  EXPECT_EQ(some->values[2][8], Rgb(0.0));
}

// 5 % off, seen through noise of 20 %; a second room is dark.
TEST(RoomErrors, AreFreedOfNoise) {
  constexpr std::size_t kCount = 20000;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.2);
  RoomTruth truth{{{{}}, {{}}}, {}};
  std::vector<Rgb> model;
  for (std::size_t i = 0; i < kCount; ++i) {
    truth.rooms.push_back(i % 2 == 0 ? 0 : 1);
    const double exact = i % 2 == 0 ? 1.0 : 0.0;
    truth.paths.values[0].push_back(exact * (Rgb(1.0) + Rgb(noise(random), noise(random), noise(random))));
    truth.paths.noise[0].push_back(exact * 3.0 * 0.2 * 0.2);
    model.emplace_back(1.05);
  }
  EXPECT_NEAR(worst_room_error(truth, 0, model), 0.05, 0.005);
  EXPECT_NEAR(worst_room_noise(truth, 0), 0.2, 1e-2);
  EXPECT_EQ(noisy_sensors(truth, 0.1).size(), kCount / 2);
  EXPECT_TRUE(noisy_sensors(truth, 0.3).empty());
}

}  // namespace
}  // namespace relume::test
