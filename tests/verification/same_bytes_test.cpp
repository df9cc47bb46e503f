// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "core/model_file.h"
#include "support/scene_builder.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

/// A corner of a room with furniture and a lamp, open above: split lumels, emitters, sky.
Scene open_room_with_a_lamp() {
  SceneBuilder b;
  const auto wall = b.material("wall", Rgb(0.6)), lamp = b.material("lamp", Rgb(0.3), Rgb(50.0));
  using P = glm::dvec3;
  b.add_quad("floor", wall, {P(0, 0, 0), P(0, 0, 3), P(4, 0, 3), P(4, 0, 0)});
  b.add_quad("wall/a", wall, {P(0, 0, 0), P(4, 0, 0), P(4, 2, 0), P(0, 2, 0)});
  b.add_quad("wall/b", wall, {P(0, 0, 3), P(0, 0, 0), P(0, 2, 0), P(0, 2, 3)});
  b.add_standing_box("cabinet", wall, P(1.03, 0, 0.57), P(1.71, 0.8, 1.13));
  b.add_box("plate", wall, P(2.2, 0.5, 1.2), P(3.1, 0.54, 2.3), SceneBuilder::Facing::outward);
  b.add_quad("screen", b.material("screen", Rgb(0.5), Rgb(0.0), true),
             {P(0.83, 0, 1.61), P(2.11, 0, 2.77), P(2.11, 1.5, 2.77), P(0.83, 1.5, 1.61)});
  b.add_quad("lamp", lamp, {P(2, 1.8, 1), P(2.4, 1.8, 1), P(2.4, 1.8, 1.3), P(2, 1.8, 1.3)});
  return b.scene();
}

std::vector<std::byte> bytes_with(std::uint32_t threads, PrecomputeReport& report) {
  PrecomputeOptions options;
  options.cluster_size = 0.2;
  options.texel_size = 0.07;
  options.quality = 64;
  options.threads = threads;
  options.sensors = {{"a", {2.0, 0.0, 0.3}, {0, 1, 0}}, {"b", {2.1, 1.0, 2.0}, {0, -1, 0}}};
  return encode_model(precompute_or_throw(open_room_with_a_lamp(), options, &report));
}

TEST(SameBytes, ForAnyNumberOfThreadsAndAnyRun) {
  PrecomputeReport report;
  const auto alone = bytes_with(1, report);
  EXPECT_GT(report.split_lumels, 20u);
  EXPECT_GT(report.occlusion_rays, 1000u);
  for (const std::uint32_t threads : {1u, 2u, 7u, 0u}) {
    EXPECT_TRUE(bytes_with(threads, report) == alone) << threads << " threads";
  }
}

}  // namespace
}  // namespace relume::test
