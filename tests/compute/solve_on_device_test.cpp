// SPDX-License-Identifier: MIT
#include "compute/standalone/solve_on_device.h"
#include "compute/row_kernels.h"

#include <gtest/gtest.h>

#include "compute/device_fixture.h"
#include "compute/near_reference.h"
#include "compute/test_models.h"
#include "core/packed_direction.h"

namespace relume::test {
namespace {

class SolveOnDevice : public DeviceTest {
 protected:
  DeviceSolution solve(const Model& model, const Lighting& lighting, const StopRule& rule,
                       const DeviceSolveOptions& options = {}) {
    auto solved = solve_on_device(device(), model, lighting, rule, options);
    EXPECT_TRUE(solved) << solved.error().message;
    return solved ? std::move(*solved) : DeviceSolution{};
  }
};

void expect_rgb(const Rgb& value, const Rgb& expected, double relative_tolerance) {
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(value[channel], expected[channel], relative_tolerance * expected[channel])
        << "channel " << channel;
  }
}

//      imports: 0 1          K            albedo        M      H
//      cluster 0     [ 0    0.5 ]         0.5          100     0
//      cluster 1     [ 0.25 0   ]         0.8            0    40
//      G             [ 0.5  0.25 ]
// B0 = (100, 32); bounce 1: 100 + 0.5 * 16 = 108, 0.8 * (40 + 25) = 52; bounce 2: 100 + 0.5 * 26 = 113, 0.8 *
// (40 + 27) = 53.6. I = 0.5 * 113 + 0.25 * 53.6 = 69.9. Numbers of few bits: 0.8 alone is rounded.
TEST_F(SolveOnDevice, TwoBouncesByHand) {
  const DrawnSystem drawn{{{0, 0}, {0, 1}}, {{0.0, 0.5}, {0.25, 0.0}}, {{0.5, 0.25}}};
  const Model model = drawn_model({drawn}, 0);
  Lighting lighting = uniform_lighting(2, Rgb(0.5), Rgb(0.0));
  lighting.exitance[0] = Rgb(100.0, 200.0, 400.0);
  lighting.albedo[1] = Rgb(0.8);
  lighting.direct[1] = Rgb(40.0, 80.0, 160.0);

  const DeviceSolution out = solve(model, lighting, {2, 0.0});
  EXPECT_EQ(out.solution.bounces, 2u);
  const Rgb scale(1.0, 2.0, 4.0);
  ASSERT_EQ(out.solution.radiosity.size(), 2u);
  ASSERT_EQ(out.irradiance.size(), 1u);
  expect_rgb(out.solution.radiosity[0], 113.0 * scale, 1e-6);
  expect_rgb(out.solution.radiosity[1], 53.6 * scale, 1e-6);
  expect_rgb(out.irradiance[0], 69.9 * scale, 1e-6);
  // The last bounce changed cluster 0 by 5 of 113.
  EXPECT_NEAR(out.solution.relative_residual, 5.0 / 113.0, 1e-6);
}

TEST_F(SolveOnDevice, NoBounceGivesWhatIsEmittedAndReflectedOnce) {
  const DrawnSystem drawn{{{0, 0}, {0, 1}}, {{0.0, 0.5}, {0.25, 0.0}}, {{0.5, 0.25}}};
  const Model model = drawn_model({drawn}, 0);
  Lighting lighting = uniform_lighting(2, Rgb(0.5), Rgb(100.0));
  lighting.direct[1] = Rgb(40.0);

  const DeviceSolution out = solve(model, lighting, {0, 1e-4});
  EXPECT_EQ(out.solution.bounces, 0u);
  expect_rgb(out.solution.radiosity[0], Rgb(100.0), 1e-7);
  expect_rgb(out.solution.radiosity[1], Rgb(120.0), 1e-7);
  expect_rgb(out.irradiance[0], Rgb(80.0), 1e-7);
  // One bounce would change cluster 0 by 0.5 * 0.5 * 120 = 30.
  EXPECT_NEAR(out.solution.relative_residual, 30.0 / 120.0, 1e-6);
  EXPECT_GE(out.solution.error_bound, 30.0 / 120.0);
}

// One face of a unit cube emits 1 lm/m2, all albedos are 0.5 (analytic form factors, solved by hand): the
// emitter ends at 1.0909091, its sides at 0.1818363, the face opposite at 0.1817458.
TEST_F(SolveOnDevice, UnitCube) {
  DrawnSystem drawn;
  drawn.bounce = to_dense(cube_matrix());
  drawn.gather = drawn.bounce;
  for (std::uint32_t face = 0; face < 6; ++face) drawn.imports.push_back({0, face});
  const Model model = drawn_model({drawn}, 0);
  Lighting lighting = uniform_lighting(6, Rgb(0.5), Rgb(0.0));
  lighting.exitance[0] = Rgb(1.0);

  const DeviceSolution out = solve(model, lighting, {1000, 1e-6});
  EXPECT_LE(out.solution.error_bound, 1e-6);
  EXPECT_NEAR(out.solution.radiosity[0].x, 1.0909091, 2e-6);
  EXPECT_NEAR(out.solution.radiosity[1].x, 0.1817458, 2e-6);
  for (std::size_t side = 2; side < 6; ++side) EXPECT_NEAR(out.solution.radiosity[side].x, 0.1818363, 2e-6);
  // What arrives is what leaves less what is emitted, over the albedo.
  EXPECT_NEAR(out.irradiance[0].x, (1.0909091 - 1.0) / 0.5, 4e-6);
}

// A closed room in which everything emits M and reflects rho shines with M / (1 - rho) everywhere.
TEST_F(SolveOnDevice, Furnace) {
  const Model model = furnace_model(96, 32);
  for (const double albedo : {0.5, 0.9, 0.99}) {
    SCOPED_TRACE(albedo);
    const Lighting lighting = uniform_lighting(96, Rgb(albedo), Rgb(10.0, 20.0, 40.0));
    const DeviceSolution out = solve(model, lighting, {10000, 1e-5});
    EXPECT_LE(out.solution.error_bound, 1e-5);
    EXPECT_FALSE(out.limited_by_rounding);
    const double allowed = out.solution.error_bound + out.rounding_bound;
    EXPECT_LT(allowed, 1e-3);
    for (const Rgb& radiosity : out.solution.radiosity) {
      expect_rgb(radiosity, Rgb(10.0, 20.0, 40.0) / (1.0 - albedo), allowed);
    }
    EXPECT_TRUE(agrees_with_reference(out, model, lighting));
  }
}

TEST_F(SolveOnDevice, ToleranceMeansWhatItMeansInTheReference) {
  const Model model = random_model({}, 11);
  const Lighting lighting = random_lighting(model, 12);
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto exact = solve_reference(matrices.bounce, lighting, {1000, 1e-12});
  ASSERT_TRUE(exact) << exact.error().message;
  for (const double tolerance : {1e-1, 1e-3, 1e-5}) {
    SCOPED_TRACE(tolerance);
    const DeviceSolution out = solve(model, lighting, {1000, tolerance});
    const auto reference = solve_reference(matrices.bounce, lighting, {out.solution.bounces, 0.0});
    ASSERT_TRUE(reference) << reference.error().message;
    EXPECT_LE(out.solution.error_bound, tolerance);
    // Two ways to the same bound; each difference of 32-bit radiosities is off by up to 2^-24 of them.
    EXPECT_NEAR(out.solution.error_bound, reference->error_bound, 0.01 * reference->error_bound + 1e-6);
    EXPECT_NEAR(out.solution.relative_residual, reference->relative_residual,
                0.01 * reference->relative_residual + 1e-6);
    double top = 0.0;
    double error = 0.0;
    for (std::size_t i = 0; i < exact->radiosity.size(); ++i) {
      top = std::max(top, exact->radiosity[i].y);
      error = std::max(error, std::abs(out.solution.radiosity[i].y - exact->radiosity[i].y));
    }
    EXPECT_LE(error / top, out.solution.error_bound + out.rounding_bound);
  }
}

TEST_F(SolveOnDevice, StopsWhenRoundingHoldsTheResidualUp) {
  const Model model = random_model({.clusters_of_system = {200}, .sky_patches = 0, .row_sum = 1.0}, 21);
  Lighting lighting = random_lighting(model, 22);
  const DeviceSolution out = solve(model, lighting, {10000, 1e-12});
  EXPECT_TRUE(out.limited_by_rounding || out.solution.error_bound == 0.0);
  EXPECT_LT(out.solution.bounces, 1000u);
  EXPECT_LT(out.solution.error_bound, 1e-5);
}

TEST_F(SolveOnDevice, ManySystemsAndBlocksOfAllFormatsAgreeWithTheReference) {
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    for (const std::uint32_t tile_rows : {1u, 8u}) {
      const Model model =
          random_model({.nodes = 25, .spanning_nodes = 30}, 31, {codec, 600 * tile_rows, tile_rows});
      ASSERT_GT(model.systems[2].bounce.blocks.size(), 3u);
      ASSERT_EQ(model.systems[2].bounce.blocks[0].tile_rows, tile_rows);
      const Lighting lighting = random_lighting(model, 32);
      std::optional<DeviceSolution> first;
      for (const RowKernel kernel : kRowKernels) {
        if (!supports_row_kernel(device().host(), kernel)) continue;
        SCOPED_TRACE(std::string(row_kernel_name(kernel)) + ", codec " +
                     std::to_string(static_cast<int>(codec)) + ", tiles of " + std::to_string(tile_rows));
        const DeviceSolution out = solve(model, lighting, {30, 0.0}, {.kernel = kernel});
        EXPECT_EQ(out.kernel, row_kernel_name(kernel));
        EXPECT_TRUE(agrees_with_reference(out, model, lighting));
        if (!first) first = out;
        EXPECT_EQ(out.irradiance, first->irradiance) << "kernels differ in their bits";
      }
    }
  }
}

TEST_F(SolveOnDevice, NodesAreTheMeansOfTheirLeaves) {
  const Model model = random_model({.nodes = 25}, 41, {ValueCodec::f32, kMaxBlockBytes, 8});
  const Lighting lighting = random_lighting(model, 42);
  const DeviceSolution out = solve(model, lighting, {30, 0.0});
  EXPECT_TRUE(agrees_with_reference(out, model, lighting));
}

// Two clusters that shine 8 and 4 and have shares of 1/4 and 3/4 make a node of (8 + 3 * 4) / 4 = 5, of which
// the only row receives a quarter. All of it is exact.
TEST_F(SolveOnDevice, ProbesAgreeWithTheReference) {
  const Model model = random_model({.nodes = 9, .spanning_nodes = 30, .probes = 21}, 43);
  const Lighting lighting = random_lighting(model, 44);
  const DeviceSolution whole = solve(model, lighting, {30, 0.0});
  ASSERT_EQ(whole.probes.size(), 84u);
  EXPECT_TRUE(agrees_with_reference(whole, model, lighting));
  // Cut into many dispatches and submissions.
  DeviceSolveOptions small;
  small.max_dispatch_form_factors = 1000;
  small.max_submit_form_factors = 5000;
  EXPECT_EQ(solve(model, lighting, {30, 0.0}, small).probes, whole.probes);
  const Model part = unloaded(model, 1);
  const Lighting of_part = random_lighting(part, 45);
  EXPECT_TRUE(agrees_with_reference(solve(part, of_part, {30, 0.0}), part, of_part));
}

TEST_F(SolveOnDevice, DirectionsAgreeWithTheReference) {
  for (const ValueCodec codec : {ValueCodec::f32, ValueCodec::unorm16, ValueCodec::sqrt8}) {
    for (const std::uint32_t tile_rows : {1u, 8u}) {
      const Model model =
          random_model({.nodes = 9, .spanning_nodes = 30, .directional = true}, 46, {codec, 4000, tile_rows});
      ASSERT_GT(model.systems[0].gather.blocks.size(), 1u);
      const Lighting lighting = random_lighting(model, 47);
      const DeviceSolution whole = solve(model, lighting, {30, 0.0});
      ASSERT_EQ(whole.moments.size(), 360u);
      EXPECT_TRUE(agrees_with_reference(whole, model, lighting));
      // Cut into many dispatches and submissions.
      DeviceSolveOptions small;
      small.max_dispatch_form_factors = 1000;
      small.max_submit_form_factors = 5000;
      EXPECT_EQ(solve(model, lighting, {30, 0.0}, small).moments, whole.moments);
      const Model part = unloaded(model, 1);
      const Lighting of_part = random_lighting(part, 48);
      EXPECT_TRUE(agrees_with_reference(solve(part, of_part, {30, 0.0}), part, of_part));
    }
  }
}

// Radiosity 8 from along -z and 4 from along (0.6, 0.8, 0) (packed: 306, 409 of 511), of which a row receives
// a half and a quarter.
TEST_F(SolveOnDevice, DirectionsByHand) {
  Model model = drawn_model({{{{0, 0}, {0, 1}}, {{0.0, 0.0}, {0.0, 0.0}}, {{0.5, 0.25}}}}, 0);
  model.systems[0].gather.blocks[0].directions = {pack_direction({0, 0, -1}), pack_direction({0.6, 0.8, 0})};
  Lighting lighting = uniform_lighting(2, Rgb(0.5), Rgb(8.0));
  lighting.exitance[1] = Rgb(4.0);
  const DeviceSolution out = solve(model, lighting, {1, 0.0});
  ASSERT_EQ(out.moments.size(), 1u);
  EXPECT_NEAR(out.moments[0][0].x, 306.0 / 511.0, 1e-6);
  EXPECT_NEAR(out.moments[0][1].y, 409.0 / 511.0, 1e-6);
  EXPECT_NEAR(out.moments[0][2].z, -4.0, 1e-6);
}

// Radiosities of 8 and 4, seen under 2 sr above and 1 sr at x: pi L00 = (16 + 4) / sqrt(4 pi), pi times the
// coefficients of y and x 16 and 4 times sqrt(3 / 4 pi).
TEST_F(SolveOnDevice, AProbeByHand) {
  Model model = drawn_model({{{{0, 0}, {0, 1}}, {{0.0, 0.0}, {0.0, 0.0}}, {}}}, 0);
  model.systems[0].probe_senders = {{0, 2.0f, {0.0f, 1.0f, 0.0f}}, {1, 1.0f, {1.0f, 0.0f, 0.0f}}};
  model.systems[0].probes = {{{}, 0, 0, 0, 2}};
  model.probe_names = {"p"};
  Lighting lighting = uniform_lighting(2, Rgb(0.5), Rgb(8.0));
  lighting.exitance[1] = Rgb(4.0);
  const DeviceSolution out = solve(model, lighting, {1, 0.0});
  ASSERT_EQ(out.probes.size(), 1u);
  const double y0 = std::sqrt(0.25 / kPi), y1 = std::sqrt(0.75 / kPi);
  EXPECT_NEAR(out.probes[0][0].x, 20.0 * y0 / kPi, 1e-6);
  EXPECT_NEAR(out.probes[0][1].x, 16.0 * y1 / kPi, 1e-6);
  EXPECT_NEAR(out.probes[0][2].x, 0.0, 1e-6);
  EXPECT_NEAR(out.probes[0][3].x, 4.0 * y1 / kPi, 1e-6);
}

TEST_F(SolveOnDevice, ANodeByHand) {
  Model model = drawn_model({{{{0, 2}}, {{0.0}, {0.0}}, {{0.25}}}}, 0);
  model.systems[0].tree = {{{0, 2, 0}}, {0.25f, 0.75f}};
  Lighting lighting = uniform_lighting(2, Rgb(0.5), Rgb(8.0));
  lighting.exitance[1] = Rgb(4.0);
  EXPECT_EQ(solve(model, lighting, {1, 0.0}).irradiance[0], Rgb(1.25));
}

TEST_F(SolveOnDevice, NodesAboveTheSystemsAreTheMeansOfTheirParts) {
  const Model model =
      random_model({.nodes = 9, .spanning_nodes = 30}, 51, {ValueCodec::f32, kMaxBlockBytes, 8});
  const Lighting lighting = random_lighting(model, 52);
  EXPECT_TRUE(agrees_with_reference(solve(model, lighting, {30, 0.0}), model, lighting));
}

TEST_F(SolveOnDevice, SystemsThatAreNotLoadedAreBlack) {
  const Model all = random_model({.nodes = 9, .spanning_nodes = 30}, 61);
  for (std::size_t system = 0; system < all.systems.size(); ++system) {
    const Model model = unloaded(all, system);
    const Lighting lighting = random_lighting(model, 62 + system);
    EXPECT_TRUE(agrees_with_reference(solve(model, lighting, {30, 0.0}), model, lighting)) << system;
  }
}

// Two systems: clusters that shine 8 and 4, and the node of both by 1/4 and 3/4, of which the only row
// receives a quarter of (8 + 3 x 4) / 4 = 5; without the second system, a quarter of 8 / 4. All of it is
// exact.
TEST_F(SolveOnDevice, ANodeAboveTheSystemsByHand) {
  Model model = drawn_model({{{{kSpanningNodes, 0}}, {{0.0}}, {{0.25}}}, {{}, {{}}, {}}}, 0);
  model.top_tree = {{0, 2}};
  model.top_parts = {{{0, 0}, 0.25f}, {{1, 0}, 0.75f}};
  Lighting lighting = uniform_lighting(2, Rgb(0.5), Rgb(8.0));
  lighting.exitance[1] = Rgb(4.0);
  EXPECT_EQ(solve(model, lighting, {1, 0.0}).irradiance[0], Rgb(1.25));
  EXPECT_EQ(solve(unloaded(model, 1), uniform_lighting(1, Rgb(0.5), Rgb(8.0)), {1, 0.0}).irradiance[0],
            Rgb(0.5));
}

TEST_F(SolveOnDevice, RandomModelsAgreeWithTheReference) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Random random(seed);
    RandomShape shape;
    shape.clusters_of_system.clear();
    for (std::uint32_t i = 0; i <= random.below(5); ++i)
      shape.clusters_of_system.push_back(1 + random.below(150));
    shape.gather_rows = random.below(200);
    shape.sky_patches = random.below(30);
    shape.row_entries = 1 + random.below(200);
    SCOPED_TRACE(seed);
    const Model model = random_model(shape, seed + 100);
    const Lighting lighting = random_lighting(model, seed + 200);
    EXPECT_TRUE(agrees_with_reference(solve(model, lighting, {50, 0.0}), model, lighting));
  }
}

TEST_F(SolveOnDevice, AnEmptyModelHasNoResult) {
  const DeviceSolution out = solve(Model{}, Lighting{}, {5, 0.0});
  EXPECT_TRUE(out.solution.radiosity.empty());
  EXPECT_TRUE(out.irradiance.empty());
}

TEST_F(SolveOnDevice, WithoutFormFactorsOnlyEmissionAndDirectLightRemain) {
  const DrawnSystem dark{{}, {{}, {}}, {{}, {}, {}}};
  const DrawnSystem single{{{1, 0}}, {{0.0}}, {{1.0}}};
  const Model model = drawn_model({dark, single}, 0);
  Lighting lighting = uniform_lighting(3, Rgb(0.25), Rgb(3.0));
  lighting.direct[1] = Rgb(8.0);

  const DeviceSolution out = solve(model, lighting, {4, 0.0});
  ASSERT_EQ(out.solution.radiosity.size(), 3u);
  expect_rgb(out.solution.radiosity[0], Rgb(3.0), 0.0);
  expect_rgb(out.solution.radiosity[1], Rgb(5.0), 0.0);
  expect_rgb(out.solution.radiosity[2], Rgb(3.0), 0.0);
  ASSERT_EQ(out.irradiance.size(), 4u);
  EXPECT_EQ(out.irradiance[0], Rgb(0.0));
  expect_rgb(out.irradiance[3], Rgb(3.0), 0.0);
  EXPECT_EQ(out.solution.relative_residual, 0.0);
}

TEST_F(SolveOnDevice, BlackSceneStaysBlack) {
  const Model model = random_model({}, 41);
  Lighting lighting = random_lighting(model, 42);
  for (auto* light : {&lighting.exitance, &lighting.direct, &lighting.sky_radiosity}) {
    for (Rgb& value : *light) value = Rgb(0.0);
  }
  const DeviceSolution out = solve(model, lighting, {10, 1e-4});
  for (const Rgb& radiosity : out.solution.radiosity) EXPECT_EQ(radiosity, Rgb(0.0));
  EXPECT_EQ(out.solution.error_bound, 0.0);
}

TEST_F(SolveOnDevice, RefusesWhatDoesNotContractInTheWordsOfTheReference) {
  DrawnSystem drawn{{{0, 0}, {0, 1}}, {{0.5, 0.5}, {0.5, 0.5}}, {}};
  Model model = drawn_model({drawn}, 0);
  // Rows that sum to 1.2: no room could look like that.
  for (float& scale : model.systems[0].bounce.blocks[0].row_scales) scale *= 1.2f;
  const Lighting lighting = uniform_lighting(2, Rgb(0.9999), Rgb(1.0));
  const auto reference = solve_reference(reference_bounce_matrix(model), lighting, {});
  const auto out = solve_on_device(device(), model, lighting, {});
  ASSERT_FALSE(reference);
  ASSERT_FALSE(out);
  EXPECT_EQ(out.error().code, ErrorCode::check_failed);
  EXPECT_EQ(out.error().message, reference.error().message);
}

TEST_F(SolveOnDevice, RefusesLightingOfTheWrongLength) {
  const Model model = random_model({}, 51);
  Lighting lighting = random_lighting(model, 52);
  lighting.direct.pop_back();
  const auto out = solve_on_device(device(), model, lighting, {});
  ASSERT_FALSE(out);
  EXPECT_EQ(out.error().code, ErrorCode::check_failed);
}

TEST_F(SolveOnDevice, TheObserverCancels) {
  const Model model = random_model({}, 61);
  const Lighting lighting = random_lighting(model, 62);
  std::uint32_t looks = 0;
  DeviceSolveOptions options;
  options.observer = [&looks](std::uint32_t, double) { return ++looks < 2; };
  const auto out = solve_on_device(device(), model, lighting, {10000, 0.0}, options);
  ASSERT_FALSE(out);
  EXPECT_EQ(out.error().code, ErrorCode::cancelled);
  EXPECT_EQ(looks, 2u);
}

}  // namespace
}  // namespace relume::test
