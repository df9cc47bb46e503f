// SPDX-License-Identifier: MIT
#include "core/probe_volume.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/model_file.h"
#include "core/probe_coefficients.h"

namespace relume {
namespace {

/// One cell of 2 m from the origin, probes 0 to 7 at its corners.
ProbeVolume one_cell() {
  ProbeVolume volume;
  volume.edges = glm::vec3(2.0f);
  volume.counts = {1, 1, 1};
  volume.nodes = {kProbeCellBit};
  ProbeCell& cell = volume.cells.emplace_back();
  std::iota(cell.probes.begin(), cell.probes.end(), 0u);
  return volume;
}

/// The wall x = 1: what lies below counts for the corners there, what lies above for the others.
ProbeVolume cell_with_a_wall() {
  ProbeVolume volume = one_cell();
  volume.planes = {{1.0f, 0.0f, 0.0f, -1.0f}};
  volume.cells[0].plane_count = 1;
  for (std::size_t c = 0; c < 8; ++c) volume.cells[0].sides[c] = (c & 1u) != 0 ? 1u : 1u << 8;
  return volume;
}

TEST(ProbeVolume, WeightsAreTrilinear) {
  const WeightedProbes at = probes_at(one_cell(), {0.5f, 1.0f, 1.5f});
  for (std::uint32_t c = 0; c < 8; ++c) {
    EXPECT_EQ(at.probes[c], c);
    const double expected = ((c & 1u) != 0 ? 0.25 : 0.75) * 0.5 * ((c & 4u) != 0 ? 0.75 : 0.25);
    EXPECT_NEAR(at.weights[c], expected, 1e-6) << c;
  }
}

TEST(ProbeVolume, ProbesBehindAWallHaveNoWeight) {
  const ProbeVolume volume = cell_with_a_wall();
  for (const float x : {0.01f, 0.5f, 0.999f, 1.001f, 1.9f}) {
    const WeightedProbes at = probes_at(volume, {x, 0.7f, 1.2f});
    float sum = 0.0f;
    for (std::uint32_t c = 0; c < 8; ++c) {
      const bool hidden = (x > 1.0f) != ((c & 1u) != 0);
      EXPECT_TRUE(!hidden || at.weights[c] == 0.0f) << x;
      sum += at.weights[c];
    }
    EXPECT_NEAR(sum, 1.0f, 1e-6f) << x;
  }
}

TEST(ProbeVolume, OutsideItIsThatOfTheNearestCell) {
  const WeightedProbes at = probes_at(one_cell(), {-5.0f, 9.0f, -0.1f});
  EXPECT_GT(at.weights[2], 0.99f);
}

TEST(ProbeVolume, HalvesAreFoundByTheirPlace) {
  ProbeVolume volume;
  volume.edges = {2.0f, 4.0f, 6.0f};
  volume.counts = {1, 1, 1};
  // Across y; the lower half across x, the upper one across z.
  volume.nodes = {1u << kProbeAxisShift | 1u, 3u, 2u << kProbeAxisShift | 5u};
  for (std::uint32_t c = 0; c < 4; ++c) {
    volume.nodes.push_back(kProbeCellBit | c);
    volume.cells.emplace_back().probes.fill(c);
  }
  EXPECT_EQ(probes_at(volume, {0.9f, 1.9f, 5.0f}).probes[0], 0u);
  EXPECT_EQ(probes_at(volume, {1.1f, 1.9f, 1.0f}).probes[0], 1u);
  EXPECT_EQ(probes_at(volume, {1.9f, 2.1f, 2.9f}).probes[0], 2u);
  EXPECT_EQ(probes_at(volume, {0.1f, 2.1f, 3.1f}).probes[0], 3u);
}

TEST(ProbeVolume, WeightsAreTrilinearInHalves) {
  ProbeVolume volume = one_cell();
  volume.edges = {4.0f, 2.0f, 2.0f};
  volume.nodes = {1u, kNoProbe, kProbeCellBit};
  const WeightedProbes at = probes_at(volume, {2.5f, 1.0f, 1.5f});
  for (std::uint32_t c = 0; c < 8; ++c) {
    const double expected = ((c & 1u) != 0 ? 0.25 : 0.75) * 0.5 * ((c & 4u) != 0 ? 0.75 : 0.25);
    EXPECT_NEAR(at.weights[c], expected, 1e-6) << c;
  }
}

// A plane across a cell of 4 x 2 x 2 m: weights fade over a quarter of its width in that direction.
TEST(ProbeVolume, WeightsFadeByTheWidthOfTheCell) {
  ProbeVolume volume = cell_with_a_wall();
  volume.edges = {4.0f, 2.0f, 2.0f};
  // Corner 1 is seen by all of the cell: x > 1; 0.25 m beyond the plane its weight is a quarter of 0.3125.
  volume.cells[0].probes.fill(kNoProbe);
  volume.cells[0].probes[1] = 1, volume.cells[0].probes[3] = 3;
  volume.cells[0].sides[3] = 0;
  const WeightedProbes at = probes_at(volume, {1.25f, 1.0f, 0.5f});
  EXPECT_NEAR(at.weights[1], 0.2, 1e-6);
  EXPECT_NEAR(at.weights[3], 0.8, 1e-6);
}

TEST(ProbeVolume, GivesTheIrradianceOfAnEvenLight) {
  // Radiance 3 from everywhere: pi x 3 lux on every plane.
  std::vector<ProbeCoefficients> probes(8);
  for (ProbeCoefficients& probe : probes) probe[0] = Rgb(3.0 * std::sqrt(4.0 * kPi));
  const WeightedProbes at = probes_at(cell_with_a_wall(), {0.4f, 0.1f, 1.7f});
  EXPECT_NEAR(probe_irradiance(probes, at, {0.6, 0.0, 0.8}).x, 3.0 * kPi, 1e-5);
}

TEST(ProbeVolume, SurvivesTheFileAndIsChecked) {
  Model model;
  model.probe_names.resize(8);
  model.probe_volume = cell_with_a_wall();
  ASSERT_TRUE(check_model(model)) << check_model(model).error().message;
  const auto read = decode_model(encode_model(model), "volume");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(probe_volume_words(read->probe_volume), probe_volume_words(model.probe_volume));

  const auto refusal = [&](auto breaks) {
    Model broken = model;
    breaks(broken.probe_volume);
    const auto checked = check_model(broken);
    return checked ? "accepted" : checked.error().message;
  };
  const auto expect = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(refusal([](ProbeVolume& v) { v.cells[0].probes[3] = 8; }), "expected probes below 8, found 8");
  expect(refusal([](ProbeVolume& v) { v.cells[0].sides[3] = 2; }),
         "expected sides of its 1 planes, found 0x2");
  expect(refusal([](ProbeVolume& v) { v.cells[0].plane_count = 2; }), "expected at most 8 planes");
  expect(refusal([](ProbeVolume& v) { v.planes.push_back(v.planes[0]); }),
         "expected 1 planes, as its cells say, found 2");
  expect(refusal([](ProbeVolume& v) { v.planes[0].x = 0.5f; }), "normals of length 1");
  expect(refusal([](ProbeVolume& v) { v.nodes[0] = 0; }),
         "node 0: expected halves across axis 0 to 2 from 1 on");
  expect(refusal([](ProbeVolume& v) { v.nodes[0] = kProbeCellBit | 1u; }),
         "node 0: expected cell 0 of 1, found 1");
  expect(refusal([](ProbeVolume& v) { v.nodes.push_back(kNoProbe); }), "expected 1 nodes and 1 cells");
  expect(refusal([](ProbeVolume& v) { v.counts[1] = 0; }), "root cells along each axis, found 0");
  expect(refusal([](ProbeVolume& v) { v.counts[2] = 0xffffffffu; }), "root cells along each axis");
  expect(refusal([](ProbeVolume& v) {
           v.nodes.resize(2, kNoProbe), v.counts = {2, 2, 1};
         }),
         "a node for each of 4 root cells, found 2");
  expect(refusal([](ProbeVolume& v) { v.edges.y = 0.0f; }), "edges above 0, found 2 x 0 x 2");
  expect(refusal([](ProbeVolume& v) { v.nodes.clear(); }), "found cells or planes without them");
  expect(refusal([](ProbeVolume& v) {
           v.nodes = {3u << kProbeAxisShift | 1u, kNoProbe, kProbeCellBit};
         }),
         "found axis 3, 1");
  // 25 levels, one in another.
  expect(refusal([](ProbeVolume& v) {
           v = {v.lower, v.edges, v.counts, {}, {}, {}};
           for (std::uint32_t level = 0; level <= kMaxProbeDepth; ++level) {
             v.nodes.push_back(1 + 2 * level);
             if (level > 0) v.nodes.push_back(kNoProbe);
           }
           v.nodes.insert(v.nodes.end(), 2, kNoProbe);
         }),
         "at most 24 levels deep");
}

}  // namespace
}  // namespace relume
