// SPDX-License-Identifier: MIT
//
// The furnace of furnace_test.cpp on the device, with the rows as they come, against its closed form and the
// reference.
#include <gtest/gtest.h>

#include "compute/standalone/solve_on_device.h"
#include "core/compare.h"
#include "core/reference_solver.h"
#include "support/matrices.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

struct Room {
  const char* name;
  Scene scene;
  double cluster_size;
};

void expect_furnace(StandaloneDevice& device, const Model& model, const std::string& name) {
  const double exitance = 2.0;
  const ReferenceMatrices matrices = reference_matrices(model);
  for (const double albedo : {0.5, 0.9, 0.99}) {
    const auto lighting = uniform_lighting(matrices.bounce.rows.rows, Rgb(albedo), Rgb(exitance));
    const StopRule rule{10000, 1e-4};
    const auto on_device = solve_on_device(device, model, lighting, rule);
    ASSERT_TRUE(on_device) << name << ": " << on_device.error().message;
    const double expected = exitance / (1.0 - albedo);
    for (const Rgb& b : on_device->solution.radiosity)
      ASSERT_NEAR(b.g, expected, 1e-3 * expected) << name << ' ' << albedo;
    for (const Rgb& i : on_device->irradiance)
      ASSERT_NEAR(i.g, expected, 1e-3 * expected) << name << ' ' << albedo;
    // Equally many bounces: what remains is 32-bit rounding.
    const auto reference = solve_reference(matrices.bounce, lighting, {on_device->solution.bounces, 0.0});
    ASSERT_TRUE(reference) << reference.error().message;
    EXPECT_LE(compare("radiosity", on_device->solution.radiosity, reference->radiosity).max_relative_error,
              1e-5)
        << name;
  }
}

TEST(DeviceFurnace, ClosedRoomsOfAnyShape) {
  auto device = StandaloneDevice::create({});
  if (!device) GTEST_SKIP() << device.error().message;
  for (const Room& room :
       {Room{"box", box_room({}), 0.5}, Room{"box that may emit", box_room({0.5, 1.0}), 0.5},
        Room{"L", l_room({}), 0.5}, Room{"sphere", sphere_room(24, 2.0, {}, {}), 0.25}}) {
    for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16}) {
      PrecomputeOptions options;
      options.cluster_size = room.cluster_size;
      options.texel_size = room.cluster_size / 2;
      options.quality = 128;
      options.max_albedo = 0.9999;
      options.codec = codec;
      expect_furnace(*device, precompute_or_throw(room.scene, options), room.name);
    }
  }
}

}  // namespace
}  // namespace relume::test
