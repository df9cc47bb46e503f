// SPDX-License-Identifier: MIT
//
// What tests of sealed_rooms() have in common: the first room is lit, the second must stay dark.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "core/reference_solver.h"
#include "precompute/leak_meter.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {

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

/// Of lumels, irradiance, and of clusters, radiosity; the first room is lit by a bulb.
struct RoomValues {
  Means lumels, clusters;
  std::vector<Rgb> sensor_direct, sensor_indirect;
};

inline RoomValues light_first_room(const Model& model, const Scene& scene, double thickness) {
  Light bulb;
  bulb.intensity = Rgb(100.0);
  bulb.position = {1.0, 1.0, 1.0};
  const RunTimeLighting lit = light(model, scene, {{bulb}, {}});
  const GatheredIrradiance gathered = solve_and_gather(model, lit);
  const auto solution = solve_reference(reference_matrices(model).bounce, lit.lighting, {});
  if (!solution) throw std::runtime_error(solution.error().message);
  SideMeans lumels(thickness), clusters(thickness);
  const auto rows = gather_offsets(model), first = cluster_offsets(model);
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
  return {lumels.means(), clusters.means(), at_sensors(model, gathered.direct),
          at_sensors(model, gathered.indirect)};
}

inline void expect_dark(const RoomValues& values) {
  EXPECT_LT(values.lumels.dark, 1e-4 * values.lumels.lit);
  EXPECT_LT(values.clusters.dark, 1e-4 * values.clusters.lit);
  EXPECT_GT(values.lumels.lit, 100.0);
  for (const Rgb& value : values.sensor_direct) EXPECT_EQ(value.r, 0.0);
  for (const Rgb& value : values.sensor_indirect) EXPECT_LT(value.r, 1e-4 * values.lumels.lit);
}

/// Whatever rows receive from where they cannot see, none of it comes from across the wall.
inline void expect_one_sided(const Model& model, double thickness) {
  const Result<LeakReport> leaks = measure_leaks(model);
  ASSERT_TRUE(leaks) << leaks.error().message;
  const auto first_room = [&](const glm::dvec3& place) { return place.x < 2.0 + 0.5 * thickness; };
  for (const RowLeak& row : leaks->rows) {
    if (row.walled > 0.0) {
      EXPECT_EQ(first_room(row.place), first_room(row.sender_place))
          << row.place.x << " " << row.sender_place.x;
    }
  }
}

inline constexpr double kLumel = 0.1;

/// Walls of a half, a tenth and a hundredth of a lumel.
inline const auto kThicknesses = testing::Values(kLumel / 2.0, kLumel / 10.0, kLumel / 100.0);

}  // namespace relume::test
