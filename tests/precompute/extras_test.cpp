// SPDX-License-Identifier: MIT
//
// extras.relume of nodes, and what the precompute makes of it.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/reference_solver.h"
#include "precompute/precompute.h"
#include "support/scene_builder.h"

namespace relume {
namespace {

using test::SceneBuilder;

/// Two squares of 1 m2 that face each other 1 m apart, in systems of their own: "below" and "above".
Scene two_squares() {
  SceneBuilder b;
  const auto paint = b.material("paint", Rgb(0.5));
  b.add_quad("below", paint, {{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}});
  b.add_quad("above", paint, {{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}});
  for (SceneNode& node : b.scene().nodes) node.extras.system = node.path;
  return b.scene();
}

constexpr std::uint32_t kRays = 64;

Model build(const Scene& scene, PrecomputeReport& report) {
  PrecomputeOptions options;
  options.texel_size = 0.125;
  options.cluster_size = 0.25;
  options.quality = kRays;
  auto model = precompute(scene, options, report);
  EXPECT_TRUE(model) << (model ? "" : model.error().message);
  EXPECT_TRUE(check_model(*model)) << check_model(*model).error().message;
  return std::move(*model);
}

Model build(const Scene& scene) {
  PrecomputeReport report;
  return build(scene, report);
}

const System& system_of(const Model& model, const std::string& name) {
  return *std::find_if(model.systems.begin(), model.systems.end(),
                       [&](const System& s) { return s.name == name; });
}

/// Form factors of each cluster of a system, ascending: the order of senders follows what is seen of the sky.
std::vector<std::vector<double>> sorted_rows(const Model& model, const std::string& name) {
  const CsrMatrix matrix = reference_bounce_matrix(model).rows;
  const auto index = std::size_t(&system_of(model, name) - model.systems.data());
  std::vector<std::vector<double>> rows;
  for (auto row = cluster_offsets(model)[index]; row < cluster_offsets(model)[index + 1]; ++row) {
    const auto begin = matrix.values.begin();
    rows.emplace_back(begin + std::ptrdiff_t(matrix.row_offsets[row]),
                      begin + std::ptrdiff_t(matrix.row_offsets[row + 1]));
    std::sort(rows.back().begin(), rows.back().end());
  }
  return rows;
}

TEST(Extras, ClustersAndProbesReflectWithoutALightmap) {
  const Model plain = build(two_squares());
  for (const char* receiver : {"clusters", "probes"}) {
    Scene scene = two_squares();
    scene.nodes[1].extras.receiver = receiver;
    const Model model = build(scene);
    const System& above = system_of(model, "above");
    EXPECT_TRUE(above.lumels.empty()) << receiver;
    EXPECT_TRUE(above.charts.empty()) << receiver;
    EXPECT_EQ(above.clusters.size(), 16u) << receiver;
    EXPECT_EQ(system_of(model, "below").lumels.size(), 64u) << receiver;
    EXPECT_EQ(reference_bounce_matrix(model).rows.values, reference_bounce_matrix(plain).rows.values)
        << receiver;
  }
}

TEST(Extras, NoneOnlyBlocks) {
  Scene scene = two_squares();
  scene.nodes[1].extras.receiver = "none";
  const Model model = build(scene);
  ASSERT_EQ(model.systems.size(), 1u);
  EXPECT_EQ(model.systems[0].name, "below");
  EXPECT_EQ(model.occluders.triangles.size(), 4u) << "it casts shadows still";
  EXPECT_EQ(model.occluders.system[2], kNone);
  // Nothing comes from it, and no sky through it: between parallel unit squares 1 m apart lies 0.1998.
  const CsrMatrix rows = reference_bounce_matrix(model).rows;
  double sum = 0.0;
  for (const double value : rows.values) sum += value / rows.rows;
  EXPECT_NEAR(sum, 1.0 - 0.199824896, 0.01);
}

TEST(Extras, TexelSizeIsTheNodesOwn) {
  Scene scene = two_squares();
  scene.nodes[0].extras.texel_size = 0.0625;
  const Model model = build(scene);
  EXPECT_EQ(system_of(model, "below").lumels.size(), 256u);
  EXPECT_EQ(system_of(model, "above").lumels.size(), 64u);
}

TEST(Extras, QualityIsRaysPerLumelOfTheNode) {
  Scene scene = two_squares();
  PrecomputeReport report;
  const Model plain = build(scene, report);
  EXPECT_EQ(report.rays, 2u * 64u * kRays);
  scene.nodes[0].extras.quality = 256;
  const Model model = build(scene, report);
  EXPECT_EQ(report.rays, 64u * 256u + 64u * kRays);
  EXPECT_EQ(sorted_rows(model, "above"), sorted_rows(plain, "above"))
      << "the other node has the rays that it had";
}

/// Most columns of any tile.
std::uint32_t most_columns(const BlockMatrix& matrix) {
  std::uint32_t most = 0;
  for (const MatrixBlock& block : matrix.blocks) {
    for (std::size_t t = 1; t < block.tile_offsets.size(); ++t)
      most = std::max(most, block.tile_offsets[t] - block.tile_offsets[t - 1]);
  }
  return most;
}

TEST(Extras, BudgetIsKeptByTheRowsOfTheNode) {
  Scene scene = two_squares();
  const Model plain = build(scene);
  ASSERT_GT(most_columns(plain.systems[0].gather), 40u);
  scene.nodes[0].extras.budget = 12;
  const Model model = build(scene);
  EXPECT_LE(most_columns(system_of(model, "below").gather), 12u);
  EXPECT_LE(most_columns(system_of(model, "below").bounce), 12u);
  // The other node keeps what its rays found, but for leaves of one node that a tile sees exactly alike.
  const auto values = [](const Model& m) { return reference_matrices(m).gather.rows; };
  const CsrMatrix full = values(plain), part = values(model);
  const auto nonzeros = [](const CsrMatrix& m, std::uint32_t first, std::uint32_t last) {
    return std::count_if(m.values.begin() + std::ptrdiff_t(m.row_offsets[first]),
                         m.values.begin() + std::ptrdiff_t(m.row_offsets[last]),
                         [](double v) { return v > 0.0; });
  };
  const auto above = gather_offsets(plain);
  EXPECT_GE(nonzeros(part, above[0], above[1]) + 4 * (above[1] - above[0]),
            nonzeros(full, above[0], above[1]));
}

TEST(Extras, EmittersAreSampledAsEmitters) {
  Scene scene = two_squares();
  EXPECT_FALSE(build(scene).materials[0].possible_emitter);
  scene.nodes[1].extras.emitter = true;
  PrecomputeReport report;
  EXPECT_TRUE(build(scene, report).materials[0].possible_emitter);
  EXPECT_GT(report.occlusion_rays, 64u * kRays / 16u);
}

}  // namespace
}  // namespace relume
