// SPDX-License-Identifier: MIT
//
// Rooms in several systems, whole and in part, on the device against the reference.
#include <gtest/gtest.h>

#include "compute/standalone/solve_on_device.h"
#include "core/compare.h"
#include "core/model_file.h"
#include "core/reference_solver.h"
#include "support/rooms_in_a_row.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

void expect_agreement(StandaloneDevice& device, const Model& model, const Scene& scene) {
  Light bulb;
  bulb.intensity = {100.0, 80.0, 60.0};
  bulb.position = {1.5, 2.2, 1.7};
  const Lighting lighting = light(model, scene, {{bulb}, {}}).lighting;
  const auto on_device = solve_on_device(device, model, lighting, {30, 0.0});
  ASSERT_TRUE(on_device) << on_device.error().message;
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto reference = solve_reference(matrices.bounce, lighting, {30, 0.0});
  ASSERT_TRUE(reference) << reference.error().message;
  const auto irradiance = gather(matrices.gather, lighting, reference->radiosity);
  // 32-bit rounding of rows and means of some hundred terms.
  EXPECT_LE(compare("radiosity", on_device->solution.radiosity, reference->radiosity).max_relative_error,
            1e-5);
  EXPECT_LE(compare("irradiance", on_device->irradiance, irradiance).max_relative_error, 1e-5);
}

TEST(DeviceSystems, WholeAndInPartAgreeWithTheReference) {
  auto device = StandaloneDevice::create({});
  if (!device) GTEST_SKIP() << device.error().message;
  const Scene scene = rooms_in_a_row({4.0, 3.0, 4.0});
  for (const std::uint32_t budget : {0u, 48u}) {
    PrecomputeOptions options;
    options.cluster_size = 0.5;
    options.texel_size = 0.25;
    options.quality = 64;
    options.budget = budget;
    options.system_lumels = 700;
    const Model model = precompute_or_throw(scene, options);
    ASSERT_GE(model.systems.size(), 3u);
    EXPECT_EQ(model.top_tree.empty(), budget == 0);
    expect_agreement(*device, model, scene);
    const auto file = std::filesystem::path(testing::TempDir()) / "relume_device_systems_test.relume";
    ASSERT_TRUE(write_model(model, file));
    const auto part = read_systems(file, std::vector{model.systems[1].name, model.systems[2].name});
    std::filesystem::remove(file);
    ASSERT_TRUE(part) << part.error().message;
    expect_agreement(*device, *part, scene);
  }
}

}  // namespace
}  // namespace relume::test
