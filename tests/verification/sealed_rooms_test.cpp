// SPDX-License-Identifier: MIT
//
// Light must not pass under, over or behind a wall, however thin it is, where floor, ceiling and side walls
// are one quad for both rooms.
#include <gtest/gtest.h>

#include "core/reference_solver.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

struct Walls {
  double thickness, texel_size, cluster_size;
};

struct Means {
  double lit = 0.0, dark = 0.0;
};

/// Area means over the surfaces on either side of the wall.
class SideMeans {
 public:
  explicit SideMeans(double thickness) : far_(2.0 + thickness) {}
  void add(double x, double area, double value) {
    if (x > 2.0 && x < far_) return;
    double* sums = x < 2.1 && x <= 2.0 ? lit_ : dark_;
    sums[0] += area;
    sums[1] += area * value;
  }
  Means means() const { return {lit_[1] / lit_[0], dark_[1] / dark_[0]}; }

 private:
  double far_;
  double lit_[2]{}, dark_[2]{};
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
  const Model model = precompute_or_throw(scene, options);
  Light bulb;
  bulb.intensity = Rgb(100.0);
  bulb.position = {1.0, 1.0, 1.0};
  const RunTimeLighting lit = light(model, scene, {{bulb}, {}});
  const GatheredIrradiance gathered = solve_and_gather(model, lit);

  SideMeans lumels(walls.thickness), clusters(walls.thickness);
  const auto rows = gather_offsets(model), first = cluster_offsets(model);
  const auto solution = solve_reference(reference_matrices(model).bounce, lit.lighting, {});
  ASSERT_TRUE(solution) << solution.error().message;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    for (std::size_t l = 0; l < system.lumels.size(); ++l) {
      const SurfaceElement& element = system.elements[system.lumels[l].element];
      if ((system.lumels[l].flags & kLumelInvalid) != 0) continue;
      const std::size_t row = rows[s] + l;
      lumels.add(element.position.x, element.area, gathered.direct[row].r + gathered.indirect[row].r);
    }
    for (std::size_t c = 0; c < system.clusters.size(); ++c)
      clusters.add(system.clusters[c].centroid.x, system.clusters[c].area,
                   solution->radiosity[first[s] + c].r);
  }
  EXPECT_LT(lumels.means().dark, 1e-4 * lumels.means().lit);
  EXPECT_LT(clusters.means().dark, 1e-4 * clusters.means().lit);
  EXPECT_GT(lumels.means().lit, 100.0);
  for (const Rgb& value : at_sensors(model, gathered.direct)) EXPECT_EQ(value.r, 0.0);
  for (const Rgb& value : at_sensors(model, gathered.indirect)) EXPECT_LT(value.r, 1e-4 * lumels.means().lit);
}

INSTANTIATE_TEST_SUITE_P(Walls, SealedRooms,
                         testing::Values(Walls{0.05, 0.05, 0.2}, Walls{0.05, 0.04, 0.2},
                                         Walls{0.05, 0.1, 0.1}, Walls{0.05, 0.1, 0.4}, Walls{0.01, 0.1, 0.2},
                                         Walls{0.0123, 0.0877, 0.3}, Walls{0.002, 0.11, 0.3}));

}  // namespace
}  // namespace relume::test
