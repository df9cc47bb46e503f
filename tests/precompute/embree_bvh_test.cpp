// SPDX-License-Identifier: MIT
#include "precompute/embree_bvh.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <random>

#include "core/model.h"
#include "support/quad_model.h"

namespace relume::test {
namespace {

struct Triangles {
  std::vector<glm::vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back({first, first + 1, first + 2});
  }
};

/// Small triangles anywhere, and many in the very same place, which no plane can part.
Triangles scattered(std::size_t count, std::size_t same) {
  Triangles scene;
  std::mt19937 random(7);
  const auto unit = [&random] { return float(random() >> 8) * 0x1p-24f; };
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 at(40.0f * unit(), 3.0f * unit(), 40.0f * unit());
    scene.add(at, at + glm::vec3(0.1f * unit(), 0.0f, 0.1f), at + glm::vec3(0.0f, 0.1f * unit(), 0.1f));
  }
  for (std::size_t i = 0; i < same; ++i) scene.add({1, 1, 1}, {2, 1, 1}, {1, 2, 1});
  return scene;
}

OccluderBvh build(const Triangles& scene, const Opacity& opacity = {}) {
  auto bvh = build_occluder_bvh(scene.positions, scene.triangles, opacity);
  EXPECT_TRUE(bvh) << bvh.error().message;
  return bvh.value_or(OccluderBvh{});
}

/// The model checks the tree: each triangle once, inside all boxes above it, no cycles, a bounded walk.
Result<void> check(const Triangles& scene, const OccluderBvh& bvh) {
  Model model;
  model.materials.push_back({"paint", false, false});
  model.nodes.push_back({"all", 0});
  Occluders& occluders = model.occluders;
  occluders.positions = scene.positions;
  occluders.triangles = scene.triangles;
  occluders.material.assign(scene.triangles.size(), 0);
  occluders.node.assign(scene.triangles.size(), 0);
  occluders.system.assign(scene.triangles.size(), kNone);
  occluders.front_uv.assign(3 * scene.triangles.size(), glm::vec2(0.0f));
  occluders.bvh = bvh;
  return check_model(model);
}

TEST(EmbreeBvh, KeepsTheModelsPromises) {
  for (const std::size_t count : {1u, 2u, 5u, 100u, 20000u}) {
    const Triangles scene = scattered(count, 0);
    const OccluderBvh bvh = build(scene);
    const auto checked = check(scene, bvh);
    EXPECT_TRUE(checked) << count << ": " << checked.error().message;
    EXPECT_EQ(bvh.triangles.size(), count);
  }
}

TEST(EmbreeBvh, StaysShallowWhereNothingCanBeTold) {
  // 30,000 equal triangles; and a scene of which each part is a hundredth of the one before.
  const Triangles same = scattered(10, 30000);
  const auto checked = check(same, build(same));
  EXPECT_TRUE(checked) << checked.error().message;
  Triangles nested;
  for (float size = 1.0f; size > 1e-30f; size *= 0.01f) {
    for (int i = 0; i < 8; ++i) nested.add({size, 0, 0}, {size, size, 0}, {size, 0, float(i) * size});
  }
  const auto deep = check(nested, build(nested));
  EXPECT_TRUE(deep) << deep.error().message;
}

TEST(EmbreeBvh, IsTheSameForAnyNumberOfThreadsAndRun) {
  const Triangles scene = scattered(60000, 2000);
  const OccluderBvh expected = build(scene);
  const tbb::global_control more(tbb::global_control::max_allowed_parallelism, 8);
  for (const int threads : {1, 2, 3, 8, 8, 8}) {
    tbb::task_arena arena(threads);
    EXPECT_EQ(arena.execute([&] { return build(scene); }), expected) << threads;
  }
}

TEST(EmbreeBvh, LeavesOutWhatStopsNothingAndSheetsThatRepeat) {
  Triangles scene = scattered(3, 3);  // 3, 4 and 5 are the same
  Opacity opacity;
  opacity.maps.push_back({});
  const auto list = [&opacity](std::uint32_t triangle, float alpha) {
    OpacityTriangle& listed = opacity.triangles.emplace_back();
    listed.triangle = triangle;
    for (glm::vec3& corner : listed.corners) corner.z = alpha;
  };
  list(1, 0.0f);
  list(3, 0.5f);
  list(5, 0.5f);
  std::vector<std::uint32_t> kept = build(scene, opacity).triangles;
  std::sort(kept.begin(), kept.end());
  EXPECT_EQ(kept, (std::vector<std::uint32_t>{0, 2, 3, 4}));
}

TEST(EmbreeBvh, OfNothingIsEmpty) {
  EXPECT_EQ(build({}), OccluderBvh{});
}

}  // namespace
}  // namespace relume::test
