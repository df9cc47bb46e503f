// SPDX-License-Identifier: MIT
//
// Models whose rows are cut to a budget, on real rooms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/model_file.h"
#include "core/reference_solver.h"
#include "support/scene_builder.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

using P = glm::dvec3;

Scene furnished_corner() {
  SceneBuilder b;
  const auto wall = b.material("wall", Rgb(0.6)), lamp = b.material("lamp", Rgb(0.3), Rgb(50.0));
  b.add_quad("floor", wall, {P(0, 0, 0), P(0, 0, 3), P(4, 0, 3), P(4, 0, 0)});
  b.add_quad("wall/a", wall, {P(0, 0, 0), P(4, 0, 0), P(4, 2, 0), P(0, 2, 0)});
  b.add_quad("wall/b", wall, {P(0, 0, 3), P(0, 0, 0), P(0, 2, 0), P(0, 2, 3)});
  b.add_standing_box("cabinet", wall, P(1.03, 0, 0.57), P(1.71, 0.8, 1.13));
  b.add_quad("lamp", lamp, {P(2, 1.8, 1), P(2.4, 1.8, 1), P(2.4, 1.8, 1.3), P(2, 1.8, 1.3)});
  return b.scene();
}

PrecomputeOptions coarse(std::uint32_t budget) {
  PrecomputeOptions options;
  options.cluster_size = 0.25;
  options.texel_size = 0.1;
  options.quality = 64;
  options.budget = budget;
  options.sensors = {{"a", {2.0, 0.5, 0.3}, {0, 1, 0}}};
  return options;
}

/// Rows stand in another order where they are cut: lumels by their place in the lightmap, then sensors.
std::vector<std::uint32_t> rows_by_place(const Model& model) {
  const System& system = model.systems[0];
  std::vector<std::uint32_t> rows(system.lumels.size() + system.sensors.size());
  std::iota(rows.begin(), rows.end(), 0u);
  std::sort(rows.begin(), rows.begin() + std::ptrdiff_t(system.lumels.size()), [&](auto a, auto b) {
    return std::pair(system.lumels[a].y, system.lumels[a].x) <
           std::pair(system.lumels[b].y, system.lumels[b].x);
  });
  return rows;
}

std::vector<Rgb> by_place(const Model& model, const std::vector<Rgb>& values) {
  std::vector<Rgb> result;
  for (const auto row : rows_by_place(model)) result.push_back(values[row]);
  return result;
}

Agreement against_full(std::uint32_t budget, ValueCodec codec) {
  const Scene scene = furnished_corner();
  const Model full = precompute_or_throw(scene, coarse(0));
  PrecomputeOptions options = coarse(budget);
  options.codec = codec;
  const Model cut = precompute_or_throw(scene, options);
  const LightSources sky{{}, Rgb(100.0)};
  return agreement(by_place(cut, solve_and_gather(cut, light(cut, scene, sky)).indirect),
                   by_place(full, solve_and_gather(full, light(full, scene, sky)).indirect));
}

TEST(Cut, ABudgetForAllLeavesGivesTheFullRows) {
  // More nodes than there are senders. The cut stops refining where differences are noise; only rounding of
  // row sums is left where it does not. What noise hides is less than the noise of 64 rays: 1 / sqrt(64 * 8)
  // of a row that lights differ all over, and much less for the mean.
  const Agreement all = against_full(100000, ValueCodec::f32);
  EXPECT_LT(all.nrmse, 0.02);
  EXPECT_LT(std::abs(all.bias), 0.002);
}

TEST(Cut, SmallBudgetsAndCodesKeepTheMean) {
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    const Agreement few = against_full(32, codec);
    // Row sums are kept, so that nodes only move light between neighbours.
    EXPECT_LT(std::abs(few.bias), 0.02) << int(codec);
    EXPECT_LT(few.nrmse, 0.1) << int(codec);
  }
}

TEST(Cut, RowSumsAreThoseOfTheRays) {
  const Scene scene = furnished_corner();
  const Model full = precompute_or_throw(scene, coarse(0)), cut = precompute_or_throw(scene, coarse(64));
  const ReferenceMatrices a = reference_matrices(full), b = reference_matrices(cut);
  const auto sum = [](const CsrMatrix& m, std::uint32_t row) {
    double total = 0.0;
    for (auto e = m.row_offsets[row]; e < m.row_offsets[row + 1]; ++e) total += m.values[e];
    return total;
  };
  ASSERT_EQ(a.gather.rows.rows, b.gather.rows.rows);
  EXPECT_LT(b.gather.rows.values.size(), a.gather.rows.values.size());
  // Sums of some hundred single precision numbers.
  const auto full_rows = rows_by_place(full), cut_rows = rows_by_place(cut);
  for (std::uint32_t i = 0; i < a.gather.rows.rows; ++i)
    EXPECT_NEAR(sum(a.gather.rows, full_rows[i]), sum(b.gather.rows, cut_rows[i]), 1e-5) << i;
}

/// What all clusters and lumels receive from light that differs from place to place, lm.
double received(const Model& model) {
  const System& system = model.systems[0];
  Lighting lighting = stored_lighting(model);
  std::vector<Rgb> radiosity;
  for (std::size_t c = 0; c < system.clusters.size(); ++c) {
    const glm::vec3 at = system.clusters[c].centroid;
    radiosity.emplace_back(1.0 + std::sin(9.0 * double(at.x)) * std::cos(7.0 * double(at.y + at.z)));
    lighting.albedo[c] = Rgb(1.0), lighting.exitance[c] = Rgb(0.0);
  }
  for (std::size_t i = 0; i < model.sky_cells.size(); ++i)
    lighting.sky_radiosity[i] = Rgb(1.0 + std::sin(double(model.sky_cells[i])));
  const ReferenceMatrices matrices = reference_matrices(model);
  const std::vector<Rgb> clusters = bounce(matrices.bounce, lighting, radiosity),
                         rows = gather(matrices.gather, lighting, radiosity);
  double sum = 0.0;
  for (std::size_t c = 0; c < clusters.size(); ++c) sum += double(system.clusters[c].area) * clusters[c].x;
  for (std::size_t i = 0; i < system.lumels.size(); ++i)
    sum += double(system.elements[system.lumels[i].element].area) * rows[i].x;
  return sum;
}

// Rows of the same rays. By areas, 16 nodes would lose percents of it.
TEST(Cut, NodesNeitherLoseNorWinLight) {
  const Scene scene = furnished_corner();
  const double full = received(precompute_or_throw(scene, coarse(0)));
  for (const std::uint32_t budget : {16u, 64u, 256u}) {
    // Rounding to single precision, of shares and of form factors.
    EXPECT_NEAR(received(precompute_or_throw(scene, coarse(budget))) / full, 1.0, 1e-5) << budget;
  }
}

TEST(Cut, TheSameBytesForAnyNumberOfThreads) {
  std::vector<std::byte> alone;
  for (const std::uint32_t threads : {1u, 7u}) {
    PrecomputeOptions options = coarse(48);
    options.threads = threads;
    options.codec = ValueCodec::sqrt8;
    const auto bytes = encode_model(precompute_or_throw(furnished_corner(), options));
    if (alone.empty()) alone = bytes;
    EXPECT_TRUE(bytes == alone) << threads << " threads";
  }
}

}  // namespace
}  // namespace relume::test
