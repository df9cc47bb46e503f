// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <numeric>

#include "core/model_file.h"
#include "core/reference_solver.h"
#include "support/alpha_materials.h"
#include "verification/closed_forms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

using P = glm::dvec3;

enum class Pane { none, blend, checkers, glass };

/// What a pane stops of the light, over many cells.
double stopped(Pane pane) {
  return pane == Pane::blend || pane == Pane::glass ? 0.25 : pane == Pane::checkers ? 0.5 : 0.0;
}

/// A rectangle at x or y = const; of checkers with cells of `cell`.
void add_pane(SceneBuilder& builder, Pane pane, const Rgb& albedo, const std::array<P, 4>& corners,
              double cell) {
  if (pane == Pane::none) return;
  std::uint32_t material = 0;
  if (pane == Pane::checkers) {
    material = checker_material(builder, albedo);
  } else {
    material = blend_material(builder, albedo, 0.25);
    SceneMaterial& made = builder.scene().materials[material];
    if (pane == Pane::glass) made.alpha_mode = AlphaMode::opaque, made.alpha = 1.0, made.transmission = 0.75;
  }
  builder.add_quad("pane", material, corners);
  map_last_quad(builder, float(glm::length(corners[1] - corners[0]) / (2.0 * cell)),
                float(glm::length(corners[3] - corners[0]) / (2.0 * cell)));
}

/// A ceiling of 4 m x 4 m, 2 m above a sensor, with a pane half way.
double seen_through(Pane pane, const Rgb& emission) {
  SceneBuilder b;
  b.add_quad("ceiling", b.material("ceiling", Rgb(0.5), emission),
             {P(-2, 2, -2), P(2, 2, -2), P(2, 2, 2), P(-2, 2, 2)});
  add_pane(b, pane, Rgb(0.5), {P(-4, 1, -4), P(-4, 1, 4), P(4, 1, 4), P(4, 1, -4)}, 0.125);
  PrecomputeOptions options;
  options.cluster_size = 1.0;
  options.texel_size = 0.5;
  options.quality = 16;
  options.sensor_quality = 1u << 16;
  options.sensors = {{"eye", {0, 0, 0}, {0, 1, 0}}};
  const Model model = precompute_or_throw(b.scene(), options);
  const CsrMatrix gather = reference_matrices(model).gather.rows;
  std::vector<std::uint32_t> node;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) node.push_back(cluster.node);
  }
  double sum = 0.0;
  const auto last_row_of_first_system = gather_offsets(model)[1] - 1;
  for (auto k = gather.row_offsets[last_row_of_first_system];
       k < gather.row_offsets[last_row_of_first_system + 1]; ++k) {
    const std::uint32_t column = gather.column_indices[k];
    if (column < node.size() && node[column] == 0) sum += gather.values[k];
  }
  return sum;
}

TEST(Alpha, APanePassesItsShareOfAFormFactor) {
  const double open = 4.0 * element_to_parallel_rectangle(2.0, 2.0, 2.0);
  for (const Pane pane : {Pane::none, Pane::blend, Pane::glass, Pane::checkers}) {
    const double expected = open * (1.0 - stopped(pane));
    const double error = std::sqrt(expected * (1.0 - expected) / (1u << 16));
    EXPECT_NEAR(seen_through(pane, Rgb(0.0)), expected, 4.0 * error) << int(pane);
    // A lamp is also sampled over its area, with a sixteenth of the samples.
    EXPECT_NEAR(seen_through(pane, Rgb(10.0)), expected, 4.0 * 4.0 * error) << "lamp, " << int(pane);
  }
}

/// A room of 4 m x 2 m x 2 m whose ceiling may shine, with a pane across its middle. All gain and loss is
/// known.
Scene divided_room(Pane pane, const Rgb& emission) {
  SceneBuilder b;
  b.add_room("room", b.material("wall", Rgb(0.5)), P(0, 0, 0), P(4, 2, 2));
  b.scene().surfaces[3].material = b.material("shining", Rgb(0.3), emission);
  add_pane(b, pane, Rgb(0.2), {P(2, 0, 0), P(2, 2, 0), P(2, 2, 2), P(2, 0, 2)}, 0.125);
  return b.scene();
}

PrecomputeOptions room_options() {
  PrecomputeOptions options;
  options.cluster_size = 0.5;
  options.texel_size = 0.25;
  options.quality = 1024;
  return options;
}

TEST(Alpha, RowsOfAClosedRoomStillSumToOne) {
  for (const Pane pane : {Pane::blend, Pane::checkers}) {
    const Model model = precompute_or_throw(divided_room(pane, Rgb(0.0)), room_options());
    EXPECT_TRUE(model.sky_cells.empty());
    const CsrMatrix bounce = reference_bounce_matrix(model).rows;
    for (std::uint32_t row = 0; row < bounce.rows; ++row) {
      const double sum =
          std::accumulate(bounce.values.begin() + std::ptrdiff_t(bounce.row_offsets[row]),
                          bounce.values.begin() + std::ptrdiff_t(bounce.row_offsets[row + 1]), 0.0);
      ASSERT_NEAR(sum, 1.0, 1e-6) << int(pane) << ", row " << row;
    }
  }
}

TEST(Alpha, ClustersHaveTheAreaOfTheirSolidPart) {
  for (const Pane pane : {Pane::blend, Pane::checkers}) {
    const Model model = precompute_or_throw(divided_room(pane, Rgb(0.0)), room_options());
    double area = 0.0;
    for (const Cluster& cluster : model.systems[0].clusters)
      area += cluster.node == 6 ? double(cluster.area) : 0.0;
    EXPECT_NEAR(area, 2.0 * 4.0 * stopped(pane), 1e-4) << "two sides, " << int(pane);
  }
}

TEST(Alpha, WhatIsEmittedIsAbsorbed) {
  for (const Pane pane : {Pane::none, Pane::blend, Pane::checkers}) {
    const Scene scene = divided_room(pane, Rgb(10.0));
    const Model model = precompute_or_throw(scene, room_options());
    const RunTimeLighting lit = light(model, scene, {});
    StopRule rule;
    rule.tolerance = 1e-7;
    const auto solution = solve_reference(reference_bounce_matrix(model), lit.lighting, rule);
    ASSERT_TRUE(solution);
    double emitted = 0.0, absorbed = 0.0;
    std::size_t i = 0;
    for (const Cluster& cluster : model.systems[0].clusters) {
      const double exitance = lit.lighting.exitance[i].x, albedo = lit.lighting.albedo[i].x;
      emitted += cluster.area * exitance;
      absorbed += cluster.area * (1.0 - albedo) * (solution->radiosity[i].x - exitance) / albedo;
      ++i;
    }
    // Rows and columns are measured apart, each with its noise.
    EXPECT_NEAR(absorbed / emitted, 1.0, 5e-3) << int(pane);
  }
}

TEST(Alpha, ALampInADividedRoomLosesNothing) {
  for (const Pane pane : {Pane::blend, Pane::checkers}) {
    const Model model = precompute_or_throw(divided_room(pane, Rgb(0.0)), room_options());
    Light lamp;
    lamp.intensity = Rgb(100.0);
    lamp.position = {0.9, 1.1, 1.2};
    const RunTimeLighting lit = light(model, divided_room(pane, Rgb(0.0)), {{lamp}, {}});
    double flux = 0.0, beyond = 0.0;
    std::size_t i = 0;
    for (const Cluster& cluster : model.systems[0].clusters) {
      const double own = cluster.area * lit.lighting.direct[i++].x;
      flux += own;
      if (cluster.centroid.x > 2.001f) beyond += own;
    }
    const double all = 4.0 * kPi * 100.0;
    EXPECT_NEAR(flux, all, 0.01 * all) << int(pane);
    // The pane as the lamp sees it, from (0.9, 1.1, 1.2): four rectangles with a corner straight ahead.
    double omega = 0.0;
    for (const double a : {1.1, 0.9}) {
      for (const double c : {1.2, 0.8})
        omega += std::atan(a * c / (1.1 * std::sqrt(a * a + c * c + 1.1 * 1.1)));
    }
    EXPECT_NEAR(beyond, 100.0 * omega * (1.0 - stopped(pane)), 0.02 * 100.0 * omega) << int(pane);
  }
}

TEST(Alpha, TheSameBytesForAnyNumberOfThreads) {
  Scene scene = divided_room(Pane::blend, Rgb(10.0));
  SceneBuilder more;
  more.scene() = scene;
  add_pane(more, Pane::checkers, Rgb(0.5), {P(1, 0.3, 0.3), P(1, 0.3, 1.5), P(1, 1.5, 1.5), P(1, 1.5, 0.3)},
           0.11);
  more.scene().nodes.back().path = "leaf";
  more.scene().materials.back().name = "leaf";
  PrecomputeOptions options = room_options();
  options.quality = 64;
  options.threads = 1;
  const auto alone = encode_model(precompute_or_throw(more.scene(), options));
  for (const std::uint32_t threads : {2u, 7u}) {
    options.threads = threads;
    EXPECT_TRUE(encode_model(precompute_or_throw(more.scene(), options)) == alone) << threads;
  }
}

}  // namespace
}  // namespace relume::test
