// SPDX-License-Identifier: MIT
//
// Light must not pass under, over or behind a wall, however thin it is, where floor, ceiling and side walls
// are one quad for both rooms.
#include "verification/sealed_rooms.h"

#include <bit>
#include <tuple>

namespace relume::test {
namespace {

struct Walls {
  double thickness, texel_size, cluster_size;
};

class SealedRooms : public testing::TestWithParam<Walls> {};

TEST_P(SealedRooms, StayDarkBesideALitOne) {
  const Walls walls = GetParam();
  const Scene scene = sealed_rooms(walls.thickness);
  PrecomputeOptions options;
  options.cluster_size = walls.cluster_size;
  options.texel_size = walls.texel_size;
  options.quality = 128;
  for (double z = 0.05; z < 2.0; z += 0.1) {
    for (const double y : {0.001, 1.999})
      options.sensors.push_back({"s", {2.0 + walls.thickness + 0.01, y, z}, {0, y < 1.0 ? 1 : -1, 0}});
  }
  expect_dark(light_first_room(precompute_or_throw(scene, options), scene, walls.thickness));
}

INSTANTIATE_TEST_SUITE_P(Walls, SealedRooms,
                         testing::Values(Walls{0.05, 0.05, 0.2}, Walls{0.05, 0.04, 0.2},
                                         Walls{0.05, 0.1, 0.1}, Walls{0.05, 0.1, 0.4}, Walls{0.01, 0.1, 0.2},
                                         Walls{0.0123, 0.0877, 0.3}, Walls{0.002, 0.11, 0.3}));

class SealedRoomsCut : public testing::TestWithParam<std::tuple<double, std::uint32_t>> {};

TEST_P(SealedRoomsCut, StayDarkBesideALitOne) {
  const auto [thickness, budget] = GetParam();
  const Scene scene = sealed_rooms(thickness);
  PrecomputeOptions options;
  options.cluster_size = 2.0 * kLumel;
  options.texel_size = kLumel;
  options.quality = 64;
  options.budget = budget;
  options.codec = ValueCodec(std::countr_zero(budget) % 3);  // 64 f32, 16 and 128 unorm16, 32 and 256 sqrt8
  const Model model = precompute_or_throw(scene, options);
  expect_dark(light_first_room(model, scene, thickness));
  expect_one_sided(model, thickness);
}

INSTANTIATE_TEST_SUITE_P(Budgets, SealedRoomsCut,
                         testing::Combine(kThicknesses, testing::Values(16u, 32u, 64u, 128u, 256u)));

}  // namespace
}  // namespace relume::test
