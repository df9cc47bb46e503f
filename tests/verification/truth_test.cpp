// SPDX-License-Identifier: MIT
//
// The whole path against the shared truth, which another program computed, by the measures of its
// compare_truth.py.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>

#include "precompute/surface_factors.h"
#include "scene/load_scene.h"
#include "scene/surface_color.h"
#include "verification/truth_data.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

/// Truth's sky formula (see its README), finely enough that no cell notices.
EquirectangularSky room_sky() {
  const glm::dvec3 zenith(1.9, 2.9, 4.7), horizon(3.4, 3.7, 3.9);
  EquirectangularSky sky{512, 256, {}};
  for (std::uint32_t y = 0; y < sky.height; ++y) {
    const double up = std::max(0.0, std::cos(kPi * (y + 0.5) / sky.height));
    sky.radiance.insert(sky.radiance.end(), sky.width, glm::vec3(horizon + (zenith - horizon) * up));
  }
  return sky;
}

class Truth : public testing::Test {
 protected:
  void SetUp() override {
    const auto shared = shared_folder();
    if (!shared || !std::filesystem::exists(*shared / "truth" / "room_A.json"))
      GTEST_SKIP() << "the shared truth set is not here";
    folder_ = *shared / "truth";
  }

  Scene scene(const std::string& name) const {
    auto loaded = load_scene(folder_ / (name + ".glb"));
    if (!loaded) throw std::runtime_error(loaded.error().message);
    return std::move(*loaded);
  }

  Model model(const std::string& name, const std::string& sensors_csv, double cluster_size, double texel_size,
              std::vector<ProbePoint> probes = {}) const {
    PrecomputeOptions options;
    options.cluster_size = cluster_size;
    options.texel_size = texel_size;
    options.sensor_quality = 16384;
    options.sensors = read_sensors(folder_ / sensors_csv);
    options.probes = std::move(probes);
    return precompute_or_throw(scene(name), options);
  }

  /// Sensors of `model` under the lights and colours of the scene called `name`.
  GatheredIrradiance sensors_under(const Model& model, const std::string& name, bool sky) const {
    const Scene edited = scene(name);
    const auto same = check_same_geometry(model, edited);
    if (!same) throw std::runtime_error(same.error().message);
    LightSources sources{edited.lights, {}};
    if (sky) sources.sky = room_sky();
    GatheredIrradiance all = solve_and_gather(model, light(model, edited, sources));
    GatheredIrradiance at{at_sensors(model, all.direct), at_sensors(model, all.indirect)};
    write_csv(name, at);
    return at;
  }

  void expect_truth(const GatheredIrradiance& at, const std::string& name) {
    const RoomTruth truth = read_room_truth(folder_ / (name + ".json"));
    std::vector<Rgb> total, true_total;
    for (std::size_t i = 0; i < truth.indirect.size(); ++i) {
      total.push_back(at.direct[i] + at.indirect[i]);
      true_total.push_back(truth.punctual[i] + truth.indirect[i]);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(at.direct[i][c], truth.punctual[i][c], 1e-3 * truth.punctual[i][c] + 1e-6)
            << "sensor " << i;
    }
    const Agreement indirect = agreement(at.indirect, truth.indirect), sum = agreement(total, true_total);
    RecordProperty(name + "_bias", std::to_string(indirect.bias));
    RecordProperty(name + "_nrmse", std::to_string(indirect.nrmse));
    for (const Agreement& a : {indirect, sum}) {
      EXPECT_LE(std::abs(a.bias), 0.005) << name;
      EXPECT_LE(a.nrmse, 0.02) << name << ", worst at sensor " << a.worst_index << " on "
                               << truth.surface[a.worst_index];
    }
  }

  /// For compare_truth.py, into RELUME_TRUTH_OUTPUT when that names a folder.
  void write_csv(const std::string& name, const GatheredIrradiance& at) const {
    const char* output = std::getenv("RELUME_TRUTH_OUTPUT");
    if (output == nullptr) return;
    std::ofstream csv(std::filesystem::path(output) / (name + ".csv"));
    csv << "id,px,py,pz,nx,ny,nz,direct_r,direct_g,direct_b,indirect_r,indirect_g,indirect_b\n";
    const std::string room = name.substr(0, name.size() - 2);
    const auto sensors = read_sensors(folder_ / (room + "_sensors.csv"));
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      csv << sensors[i].name;
      for (const glm::dvec3& v : {sensors[i].position, sensors[i].normal, at.direct[i], at.indirect[i]})
        csv << ',' << v.x << ',' << v.y << ',' << v.z;
      csv << '\n';
    }
  }

  std::filesystem::path folder_;
};

/// |c - c_true| / L00, root mean square over probes, coefficients and channels.
double probe_error(const std::vector<ProbeCoefficients>& values,
                   const std::vector<ProbeCoefficients>& truth) {
  const FlatCoefficients found = flat_coefficients(values), expected = flat_coefficients(truth);
  double squares = 0.0;
  for (std::size_t i = 0; i < expected.values.size(); ++i) {
    const Rgb off = (found.values.at(i) - expected.values[i]) / expected.magnitudes[i];
    squares += glm::dot(off, off);
  }
  return std::sqrt(squares / (3.0 * double(expected.values.size())));
}

TEST_F(Truth, FurnishedRoomUnderThreeLightingsOnOnePrecompute) {
  const ProbeTruth probes = read_probe_truth(folder_ / "room_A_probes.json");
  const Model room = model("room_A", "room_sensors.csv", 0.15, 0.05, probes.points);
  const Scene scene_a = scene("room_A");
  const double off = probe_error(solve_probes(room, light(room, scene_a, {scene_a.lights, room_sky()})),
                                 probes.coefficients);
  RecordProperty("room_A_probes", std::to_string(off));
  EXPECT_LE(off, 0.02);
  expect_truth(sensors_under(room, "room_A", true), "room_A");
  expect_truth(sensors_under(room, "room_B", false), "room_B");
  expect_truth(sensors_under(room, "room_C", true), "room_C");
}

TEST_F(Truth, TwoRooms) {
  expect_truth(sensors_under(model("two_rooms_A", "two_rooms_sensors.csv", 0.12, 0.06), "two_rooms_A", false),
               "two_rooms_A");
}

TEST_F(Truth, SealedRoomStaysDark) {
  const Model rooms = model("two_rooms_sealed_A", "two_rooms_sealed_sensors.csv", 0.12, 0.06);
  const GatheredIrradiance at = sensors_under(rooms, "two_rooms_sealed_A", false);
  expect_truth(at, "two_rooms_sealed_A");
  const RoomTruth truth = read_room_truth(folder_ / "two_rooms_sealed_A.json");
  double sums[2]{}, largest = 0.0;
  int counts[2]{};
  for (std::size_t i = 0; i < truth.room.size(); ++i) {
    const int dark = truth.room[i] == "dark" ? 1 : 0;
    ++counts[dark];
    for (int c = 0; c < 3; ++c) {
      sums[dark] += at.indirect[i][c];
      if (dark == 1) largest = std::max(largest, at.indirect[i][c]);
    }
  }
  EXPECT_GT(counts[1], 100);
  const double lit = sums[0] / (3.0 * counts[0]);
  EXPECT_LT(sums[1] / (3.0 * counts[1]), 1e-4 * lit);
  EXPECT_LT(largest, 1e-4 * lit);
}

/// Light that no precompute knows, against a truth that none of it had a part in: the error is below what was
/// asked for in each room. Returns how large it is.
double worst_room(const RoomTruth& truth, const std::vector<Rgb>& indirect) {
  std::map<std::string, std::pair<std::vector<Rgb>, std::vector<Rgb>>> rooms;
  for (std::size_t i = 0; i < indirect.size(); ++i) {
    auto& [values, expected] = rooms[truth.room.empty() ? "" : truth.room[i]];
    values.push_back(indirect[i]);
    expected.push_back(truth.indirect[i]);
  }
  double worst = 0.0;
  for (const auto& [name, room] : rooms) {
    if (name != "door") worst = std::max(worst, agreement(room.first, room.second).nrmse);
  }
  return worst;
}

TEST_F(Truth, ErrorTargetsAreKeptInEveryRoom) {
  constexpr double error = 0.05;
  const auto reached = [&](const Model& model, const std::string& name, bool sky) {
    return worst_room(read_room_truth(folder_ / (name + ".json")), sensors_under(model, name, sky).indirect);
  };
  PrecomputeOptions options;
  options.error = error;
  options.sensors = read_sensors(folder_ / "room_sensors.csv");
  PrecomputeReport report;
  const Model room = precompute_or_throw(scene("room_A"), options, &report);
  EXPECT_LT(report.error.total(), 1.2 * error);
  EXPECT_LT(reached(room, "room_A", true), error);
  EXPECT_LT(reached(room, "room_B", false), error);
  EXPECT_LT(reached(room, "room_C", true), error);
  options.sensors = read_sensors(folder_ / "two_rooms_sensors.csv");
  const Model rooms = precompute_or_throw(scene("two_rooms_A"), options);
  EXPECT_LT(reached(rooms, "two_rooms_A", false), error);
}

TEST_F(Truth, FormFactorsBetweenSurfaces) {
  const auto cases = read_factor_truth(folder_ / "form_factors.json");
  ASSERT_FALSE(cases.empty());
  for (const FactorTruth& one : cases) {
    const auto scene = load_scene(folder_ / one.mesh);
    ASSERT_TRUE(scene) << scene.error().message;
    const auto found = surface_factors(*scene, FactorGrouping::node, 1u << 21);
    ASSERT_TRUE(found) << found.error().message;
    const auto index = [&](const std::string& name) {
      const auto at = std::find(found->surfaces.begin(), found->surfaces.end(), name);
      if (at == found->surfaces.end()) throw std::runtime_error(one.name + ": no surface " + name);
      return std::size_t(at - found->surfaces.begin());
    };
    for (const auto& pair : one.pairs) {
      const std::size_t i = index(pair.from), j = index(pair.to);
      const double factor = found->factors[i][j];
      EXPECT_NEAR(factor, pair.value, std::max(5e-4, 0.005 * pair.value))
          << one.name << ' ' << pair.from << ' ' << pair.to;
      const double error = std::hypot(found->areas[i] * found->standard_error[i][j],
                                      found->areas[j] * found->standard_error[j][i]);
      EXPECT_LE(std::abs(found->areas[i] * factor - found->areas[j] * found->factors[j][i]),
                4.0 * error + 1e-12)
          << one.name << ' ' << pair.from << ' ' << pair.to;
    }
    for (const std::string& name : one.closed_rows) {
      const auto& row = found->factors[index(name)];
      EXPECT_NEAR(std::accumulate(row.begin(), row.end(), 0.0), 1.0, 1e-12) << one.name << ' ' << name;
    }
  }
}

}  // namespace
}  // namespace relume::test
