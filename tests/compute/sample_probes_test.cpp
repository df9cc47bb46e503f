// SPDX-License-Identifier: MIT
//
// relume_sample_probes.glsl against core/probe_volume.h.
#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <array>
#include <glm/geometric.hpp>

#include "compute/pass_fixture.h"
#include "compute/run_kernel.h"
#include "compute/test_models.h"
#include "core/probe_coefficients.h"
#include "spirv/sample_probes.h"

namespace relume::test {
namespace {

/// Of a workgroup of sample_probes.comp.
constexpr std::uint32_t kInvocations = 8;

class SampleProbes : public PassTest {
 protected:
  /// Binds storage buffers 0, 1, ... and runs one invocation for each place.
  void run(const std::vector<BufferRange>& buffers, std::uint32_t places) {
    run_kernel(device(), {sample_probes_spirv, buffers, places / kInvocations});
  }
};

/// Two root cells of 1 x 1.5 x 0.5 m side by side along x; the first is halved three times, across each axis,
/// and of its parts one is empty. Corners take probes by chance, and planes of all directions cut them by
/// chance.
ProbeVolume random_volume(Random& random, std::uint32_t probes) {
  ProbeVolume volume;
  volume.lower = {-1.0f, 0.5f, 2.0f};
  volume.edges = {1.0f, 1.5f, 0.5f};
  volume.counts = {2, 1, 1};
  volume.nodes = {1u << kProbeAxisShift | 2u, kProbeCellBit};
  for (const std::uint32_t first : {4u, 6u}) volume.nodes.push_back(2u << kProbeAxisShift | first);
  for (const std::uint32_t first : {8u, 10u, 12u, 14u}) volume.nodes.push_back(first);
  for (std::uint32_t child = 0; child < 8; ++child)
    volume.nodes.push_back(child == 5 ? kNoProbe : kProbeCellBit | (1 + child - (child > 5 ? 1 : 0)));
  for (int i = 0; i < 8; ++i) {
    ProbeCell& cell = volume.cells.emplace_back();
    cell.first_plane = std::uint32_t(volume.planes.size());
    cell.plane_count = random.below(kMaxCellPlanes + 1);
    for (std::uint32_t c = 0; c < 8; ++c) {
      cell.probes[c] = random.below(8) == 0 ? kNoProbe : random.below(probes);
      for (std::uint32_t p = 0; p < cell.plane_count; ++p) {
        const std::uint32_t side = random.below(6);
        if (side < 2) cell.sides[c] = std::uint16_t(cell.sides[c] | (1u << (p + 8 * side)));
      }
    }
    for (std::uint32_t p = 0; p < cell.plane_count; ++p) {
      const glm::vec3 normal =
          glm::normalize(glm::vec3(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5));
      volume.planes.push_back(
          {normal, -glm::dot(normal, glm::vec3(0.0f, 1.25f, 2.25f)) + random.unit() - 0.5});
    }
  }
  return volume;
}

TEST_F(SampleProbes, GivesWhatTheProcessorGives) {
  Random random(1);
  const ProbeVolume volume = random_volume(random, 20);
  Model model;
  model.probe_names.resize(20);
  model.probe_volume = volume;
  ASSERT_TRUE(check_model(model)) << check_model(model).error().message;
  std::vector<ProbeCoefficients> coefficients(20);
  std::vector<kernels::vec4> stored, places;
  for (ProbeCoefficients& probe : coefficients) {
    for (std::size_t h = 0; h < kProbeHarmonics; ++h) {
      probe[h] = Rgb(float(h == 0 ? 5.0 : random.unit()), 1.0, float(random.unit()));
      stored.push_back({float(probe[h].x), 1.0f, float(probe[h].z), 0.0f});
    }
  }
  std::vector<glm::vec3> points, normals;
  for (int i = 0; i < 2000; ++i) {
    points.push_back(volume.lower + glm::vec3(2.4 * random.unit() - 0.2, 1.9 * random.unit() - 0.2,
                                              0.9 * random.unit() - 0.2));
    normals.push_back(
        glm::normalize(glm::vec3(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5)));
    places.push_back({points.back().x, points.back().y, points.back().z, 0.0f});
    places.push_back({normals.back().x, normals.back().y, normals.back().z, 0.0f});
  }
  const std::vector<std::uint32_t> words = probe_volume_words(volume);
  const std::vector<BufferRange> buffers{
      allocate("places", 16 * places.size()), allocate("volume", 4 * words.size()),
      allocate("coefficients", 16 * stored.size()), allocate("answers", 32 * points.size())};
  upload(buffers[0], places);
  upload(buffers[1], words);
  upload(buffers[2], stored);
  run(buffers, std::uint32_t(points.size()));
  const std::vector<Rgb> answers = read_rgb(buffers[3]);
  int covered = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const WeightedProbes at = probes_at(volume, points[i]);
    const Rgb expected = probe_irradiance(coefficients, at, normals[i]);
    const bool seen = std::any_of(at.weights.begin(), at.weights.end(), [](float w) { return w > 0.0f; });
    covered += seen ? 1 : 0;
    EXPECT_EQ(answers[2 * i + 1].x, seen ? 1.0 : 0.0) << i;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(answers[2 * i][c], expected[c], 1e-4) << i;
  }
  EXPECT_GT(covered, 1000);
  EXPECT_LT(covered, 2000);
}

}  // namespace
}  // namespace relume::test
