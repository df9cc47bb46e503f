// SPDX-License-Identifier: MIT
//
// Directional lightmaps against closed forms, and what they tell of bent normals against sensors that have
// them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/directional_irradiance.h"
#include "core/model_file.h"
#include "core/reference_solver.h"
#include "core/sky.h"
#include "support/scene_builder.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

PrecomputeOptions directional(double cluster_size) {
  PrecomputeOptions options;
  options.cluster_size = cluster_size;
  options.texel_size = cluster_size / 2;
  options.directional = true;
  return options;
}

/// A gather row: what arrives, where most of it comes from, and the receiver.
struct Arriving {
  Rgb irradiance{0.0};
  glm::dvec3 direction{0.0}, normal{0.0}, position{0.0};
};

/// Gather rows of all systems; checks that |D| <= I.
std::vector<Arriving> arriving(const Model& model, const Lighting& lighting) {
  StopRule rule;
  rule.tolerance = 1e-6;
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto solution = solve_reference(matrices.bounce, lighting, rule);
  if (!solution) throw std::runtime_error(solution.error().message);
  const std::vector<Rgb> irradiance = gather(matrices.gather, lighting, solution->radiosity);
  const auto moments = directional_irradiance(model, lighting, solution->radiosity);
  EXPECT_EQ(moments.size(), irradiance.size());
  std::vector<Arriving> rows;
  for (const System& system : model.systems) {
    for (const Lumel& lumel : system.lumels) {
      const SurfaceElement& element = system.elements[lumel.element];
      rows.push_back({{}, {}, glm::dvec3(element.normal), glm::dvec3(element.position)});
    }
    for (const Sensor& sensor : system.sensors)
      rows.push_back({{}, {}, glm::dvec3(sensor.normal), sensor.position});
  }
  for (std::size_t row = 0; row < rows.size() && row < moments.size(); ++row) {
    const glm::dvec3 green(moments[row][0].g, moments[row][1].g, moments[row][2].g);
    EXPECT_LE(glm::length(green), irradiance[row].g * (1.0 + 1e-6)) << row;
    rows[row].irradiance = irradiance[row];
    rows[row].direction = dominant_direction(moments[row], irradiance[row]);
  }
  return rows;
}

Scene floor_under_the_sky() {
  SceneBuilder builder;
  builder.add_quad("floor", builder.material("floor", Rgb(0.5)),
                   {glm::dvec3{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}});
  return builder.scene();
}

// Integrals of direction x cosine over the hemisphere, over that of the cosine: 2/3 along the normal.
TEST(Directional, AFurnaceShinesTwoThirdsAlongEachNormal) {
  const Scene scene = furnished_room({0.5, 3.0});
  const Model model = precompute_or_throw(scene, directional(0.5));
  const auto rows = arriving(model, stored_lighting(model));
  ASSERT_GT(rows.size(), 500u);
  double worst = 0.0;
  std::size_t dark = 0;  // inside the furniture
  for (const Arriving& row : rows) {
    if (row.irradiance.g == 0.0) ++dark;
    if (row.irradiance.g > 0.0) worst = std::max(worst, glm::length(row.direction - 2.0 / 3.0 * row.normal));
  }
  EXPECT_LT(10 * dark, rows.size());
  EXPECT_LT(worst, 0.02);  // 512 rays
}

// The same of half a hemisphere, x > 0: 4 / (3 pi) along x and 2/3 along the normal.
TEST(Directional, AHalfSkyPullsToItsSide) {
  const Model model = precompute_or_throw(floor_under_the_sky(), directional(0.5));
  Lighting lighting = stored_lighting(model);
  lighting.sky_radiosity.clear();
  for (const std::uint32_t cell : model.sky_cells)
    lighting.sky_radiosity.emplace_back(sky_cell_direction(cell, model.sky_resolution).x > 0.0 ? 100.0 : 0.0);
  for (const Arriving& row : arriving(model, lighting)) {
    EXPECT_NEAR(row.irradiance.g, 50.0, 0.5);
    EXPECT_NEAR(row.direction.x, 4.0 / (3.0 * kPi), 0.01);
    EXPECT_NEAR(row.direction.y, 2.0 / 3.0, 0.01);
    EXPECT_NEAR(row.direction.z, 0.0, 0.01);
  }
}

/// A lamp of 5 x 5 cm, 3 m from the origin along `d`, which it faces, above a dark floor.
Scene small_lamp(const glm::dvec3& d) {
  const glm::dvec3 u = glm::normalize(glm::cross(d, glm::dvec3(0, 1, 0))), v = glm::cross(d, u),
                   middle = 3.0 * d;
  SceneBuilder builder;
  const double r = 0.025;
  builder.add_quad(
      "lamp", builder.material("lamp", Rgb(0.0), Rgb(1000.0)),
      {middle - r * u - r * v, middle - r * u + r * v, middle + r * u + r * v, middle + r * u - r * v});
  builder.add_quad("floor", builder.material("dark", Rgb(0.0)),
                   {glm::dvec3{-1, -0.5, -1}, {-1, -0.5, 1}, {1, -0.5, 1}, {1, -0.5, -1}});
  return builder.scene();
}

TEST(Directional, ASmallFarLampIsOneDirection) {
  const glm::dvec3 d(2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0);
  PrecomputeOptions options = directional(0.5);
  options.sensors = {{"up", {0, 0, 0}, {0, 1, 0}}, {"facing", {0, 0, 0}, d}};
  for (const double error : {0.0, 0.05}) {
    options.error = error;
    const Model model = precompute_or_throw(small_lamp(d), options);
    const auto rows = arriving(model, stored_lighting(model));
    ASSERT_GT(rows.size(), 2u);
    for (std::size_t i = rows.size() - 2; i < rows.size(); ++i) {
      ASSERT_GT(rows[i].irradiance.g, 0.0);
      EXPECT_LT(glm::length(rows[i].direction - d), 0.006) << i;  // packed to 1 / 511
    }
  }
}

/// Lumels in the order of their places: a cut numbers clusters by its trees.
void sort_by_place(std::vector<Arriving>& rows) {
  std::sort(rows.begin(), rows.end(), [](const Arriving& a, const Arriving& b) {
    return std::tie(a.position.x, a.position.y, a.position.z) <
           std::tie(b.position.x, b.position.y, b.position.z);
  });
}

/// Root mean square of what directions differ by, each counted as its light.
double difference(std::vector<Arriving> rows, std::vector<Arriving> reference) {
  sort_by_place(rows), sort_by_place(reference);
  double squares = 0.0, light = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const glm::dvec3 off = rows[i].direction - reference[i].direction;
    squares += reference[i].irradiance.g * glm::dot(off, off);
    light += reference[i].irradiance.g;
  }
  return std::sqrt(squares / light);
}

TEST(Directional, StandsTheCutAndEveryStoredPrecision) {
  const Scene scene = lamp_room(0.3, 0.5);
  PrecomputeOptions options = directional(0.5);
  const Model full = precompute_or_throw(scene, options);
  const auto reference = arriving(full, stored_lighting(full));
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    options.codec = codec;
    options.budget = 0;
    const Model recoded = precompute_or_throw(scene, options);
    EXPECT_LT(difference(arriving(recoded, stored_lighting(recoded)), reference), 0.01);
    options.budget = 96;
    const Model cut = precompute_or_throw(scene, options);
    EXPECT_EQ(cut.systems[0].gather.blocks[0].tile_rows, 8u);
    EXPECT_LT(difference(arriving(cut, stored_lighting(cut)), reference), 0.02);
  }
}

TEST(Directional, ChangesNothingElse) {
  const Scene scene = lamp_room(0.3, 0.5);
  PrecomputeOptions options = directional(0.5);
  for (const std::uint32_t budget : {0u, 96u}) {
    options.budget = budget;
    options.directional = true;
    Model with = precompute_or_throw(scene, options);
    options.directional = false;
    const Model without = precompute_or_throw(scene, options);
    EXPECT_NE(encode_model(with), encode_model(without));
    for (System& system : with.systems) {
      for (MatrixBlock& block : system.gather.blocks) block.directions.clear();
    }
    with.provenance.options = without.provenance.options;
    EXPECT_EQ(encode_model(with), encode_model(without));
  }
}

// Sensors on the floor of a room with a lamp, and the same with normals that lean by 30 degrees: from the
// first, d tells most of what the second receive.
TEST(Directional, TellsTheLightOfBentNormals) {
  PrecomputeOptions options = directional(0.5);
  const double lean = kPi / 6.0;
  for (double a = 0.3; a < 3.9; a += 0.35) {
    for (double b = 0.3; b < 3.9; b += 0.35) {
      const double turn = 7.0 * a + 3.0 * b;
      options.sensors.push_back({"flat", {a, 0.001, b}, {0, 1, 0}});
      options.sensors.push_back(
          {"bent",
           {a, 0.001, b},
           {std::sin(lean) * std::cos(turn), std::cos(lean), std::sin(lean) * std::sin(turn)}});
    }
  }
  for (const auto& [albedo, most] : {std::pair(0.1, 0.1), std::pair(0.7, 0.55)}) {
    const Model model = precompute_or_throw(lamp_room(0.6, albedo), options);
    const auto rows = arriving(model, stored_lighting(model));
    std::vector<Rgb> flat, told, truth;
    for (std::size_t i = rows.size() - options.sensors.size(); i < rows.size(); i += 2) {
      const Arriving &here = rows[i], &bent = rows[i + 1];
      flat.push_back(here.irradiance);
      told.push_back(here.irradiance * bent_irradiance_factor(here.direction, here.normal, bent.normal));
      truth.push_back(bent.irradiance);
    }
    EXPECT_LT(agreement(told, truth).nrmse, most * agreement(flat, truth).nrmse) << albedo;
  }
}

}  // namespace
}  // namespace relume::test
