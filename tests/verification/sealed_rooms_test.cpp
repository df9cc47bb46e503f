// SPDX-License-Identifier: MIT
//
// Light must not pass under, over or behind a wall, however thin it is, where floor, ceiling and side walls
// are one quad for both rooms.
#include "verification/sealed_rooms.h"

#include <algorithm>
#include <array>
#include <bit>
#include <glm/common.hpp>
#include <string>
#include <tuple>

#include "support/scene_builder.h"

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

/// A room of 2 m whose six boards stick out by so much at all edges.
Scene house_of_boards(double out) {
  SceneBuilder builder;
  const auto board = builder.material("board", Rgb(0.5));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double at : {0.0, 2.0}) {
      glm::dvec3 lower(-out), upper(2.0 + out);
      lower[axis] = upper[axis] = at;
      const auto corner = [&](bool u, bool v) {
        glm::dvec3 p = lower;
        p[(axis + 1) % 3] = u ? upper[(axis + 1) % 3] : lower[(axis + 1) % 3];
        p[(axis + 2) % 3] = v ? upper[(axis + 2) % 3] : lower[(axis + 2) % 3];
        return p;
      };
      std::array<glm::dvec3, 4> corners{corner(false, false), corner(true, false), corner(true, true),
                                        corner(false, true)};
      if (at > 0.0) std::swap(corners[1], corners[3]);
      builder.add_quad("board " + std::to_string(2 * axis + (at > 0.0 ? 1 : 0)), board, corners);
    }
  }
  return builder.scene();
}

class HouseOfBoards : public testing::TestWithParam<double> {};

// The last lumels of each board lie partly in the room, and have no neighbours outside.
TEST_P(HouseOfBoards, IsDarkInsideUnderAnySky) {
  PrecomputeOptions options;
  options.texel_size = kLumel;
  options.cluster_size = 2.0 * kLumel;
  options.quality = 64;
  const Model model = precompute_or_throw(house_of_boards(GetParam()), options);
  Lighting lighting = stored_lighting(model);
  lighting.sky_radiosity.assign(model.sky_cells.size(), Rgb(100.0));
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto solution = solve_reference(matrices.bounce, lighting, {});
  ASSERT_TRUE(solution) << solution.error().message;
  double inside = 0.0, outside = 0.0;
  std::size_t cluster = 0;
  for (const System& system : model.systems) {
    for (const Cluster& c : system.clusters) {
      const glm::vec3 off = glm::abs(c.centroid - 1.0f);
      double& sum = std::max({off.x, off.y, off.z}) <= 1.0f + 1e-5f ? inside : outside;
      sum += double(c.area) * solution->radiosity[cluster++].g;
    }
  }
  EXPECT_GT(outside, 0.0);
  EXPECT_LT(inside, 1e-4 * outside);
}

// In lumels: a tenth, a third, not quite a half, nearly one.
INSTANTIATE_TEST_SUITE_P(SticksOut, HouseOfBoards, testing::Values(0.01, 0.033, 0.047, 0.09));

}  // namespace
}  // namespace relume::test
