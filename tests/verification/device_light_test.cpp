// SPDX-License-Identifier: MIT
//
// Direct light on the device against that of the processor (Embree, double precision): the same sample
// points, the same rays. Rays within rounding of an edge may differ.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "compute/device_fixture.h"
#include "compute/standalone/light_session.h"
#include "core/light_patches.h"
#include "core/ray_offset.h"
#include "precompute/direct_irradiance.h"
#include "precompute/ray_caster.h"
#include "support/alpha_materials.h"
#include "support/quad_model.h"
#include "support/rooms_in_a_row.h"
#include "verification/rooms.h"
#include "verification/whole_path.h"

namespace relume::test {
namespace {

using P = glm::dvec3;

Light point_light(const P& position, double candela = 100.0, double range = 0.0) {
  Light light;
  light.position = position;
  light.intensity = Rgb(candela, 0.5 * candela, 0.25 * candela);
  light.range = range;
  return light;
}

Light spot_light(const P& position, const P& direction, double inner, double outer, double range = 0.0) {
  Light light = point_light(position, 300.0, range);
  light.type = LightType::spot;
  light.direction = glm::normalize(direction);
  light.inner_cone_angle = inner;
  light.outer_cone_angle = outer;
  return light;
}

Light sun(const P& direction) {
  Light light;
  light.type = LightType::directional;
  light.intensity = Rgb(1000.0, 900.0, 800.0);
  light.direction = glm::normalize(direction);
  return light;
}

std::vector<Light> all_kinds() {
  return {point_light({1.3, 2.2, 1.1}), spot_light({3.6, 2.3, 3.0}, {-0.3, -1, -0.4}, 0.2, 0.6),
          point_light({4.0, 0.4, 2.0}, 50.0, 1.5), sun({0.3, -1, 0.2}),
          spot_light({2.5, 1.2, 0.01}, {0, 0, 1}, 0.0, 1.2, 3.0)};
}

PrecomputeOptions coarse(double texel_size) {
  PrecomputeOptions options;
  options.texel_size = texel_size;
  options.cluster_size = 3.0 * texel_size;
  options.quality = 8;
  return options;
}

/// A room with a pane and a checkered screen in it, and two sensors.
Model alpha_room() {
  SceneBuilder b;
  const std::uint32_t wall = b.material("wall", Rgb(0.5));
  int number = 0;
  for (const Quad& quad : box_quads({0, 0, 0}, {5, 2.5, 4}, /*inward=*/true)) {
    b.add_quad("wall" + std::to_string(number++), wall,
               {quad.corner, quad.corner + quad.edge_s, quad.corner + quad.edge_s + quad.edge_t,
                quad.corner + quad.edge_t});
  }
  b.add_quad("pane", blend_material(b, Rgb(0.5), 0.4),
             {P(1, 0.5, 1), P(2, 0.5, 1), P(2, 0.7, 2), P(1, 0.7, 2)});
  b.add_quad("screen", checker_material(b, Rgb(0.5)),
             {P(2.5, 0.9, 1), P(4, 0.9, 1), P(4, 0.9, 3), P(2.5, 0.9, 3)});
  map_last_quad(b, 3.0f, 4.0f);
  PrecomputeOptions options = coarse(0.2);
  options.sensors = {{"floor", {3.0, 0.0, 2.0}, {0, 1, 0}}, {"air", {1.5, 0.2, 1.5}, {0, 1, 0}}};
  return precompute_or_throw(b.scene(), options);
}

/// Largest difference over all values, as a share of the largest value; and how many differ by more than 1e-4
/// of it.
struct Difference {
  double worst = 0.0;
  std::size_t far = 0;
  std::size_t count = 0;
};

Difference difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0.0;
  for (const Rgb& value : b) largest = std::max(largest, value.r);
  Difference out;
  out.count = a.size();
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const double share = std::abs(a[i].r - b[i].r) / largest;
    out.worst = std::max(out.worst, share);
    if (share > 1e-4) ++out.far;
  }
  return out;
}

class DeviceLight : public DeviceTest {
 protected:
  LightSession session(const Model& model, const LightSessionOptions& options = {}) {
    auto made = LightSession::create(device(), model, options);
    if (!made) throw std::runtime_error(made.error().message);
    return std::move(*made);
  }

  /// After these lights.
  DeviceDirectLight lit(LightSession& session, const std::vector<Light>& lights,
                        std::uint64_t* rays = nullptr) {
    const auto set = session.set_lights(lights);
    EXPECT_TRUE(set) << set.error().message;
    if (set && rays != nullptr) *rays = set->rays;
    return {session.read_clusters().value(), session.read_gather().value()};
  }

  void expect_processor_agrees(const Model& model, const std::vector<Light>& lights,
                               double patches = kPatchesPerElement) {
    const auto expected = direct_irradiance(model, lights, 0, patches);
    ASSERT_TRUE(expected) << expected.error().message;
    LightSessionOptions options;
    options.light.patches_per_element = patches;
    LightSession on_device = session(model, options);
    const DeviceDirectLight found = lit(on_device, lights);
    const Difference clusters = difference(found.clusters, expected->clusters);
    const Difference gather = difference(found.gather, expected->gather);
    RecordProperty("worst", std::to_string(clusters.worst));
    // An edge met otherwise changes one patch of some hundred of a cluster.
    EXPECT_LE(clusters.far, clusters.count / 200) << clusters.worst << " of " << clusters.count;
    EXPECT_LE(gather.far, gather.count / 200) << gather.worst << " of " << gather.count;
    EXPECT_LE(clusters.worst, 0.02);
  }
};

TEST_F(DeviceLight, AgreesWithTheProcessorInAFurnishedRoom) {
  expect_processor_agrees(precompute_or_throw(furnished_room({}), coarse(0.2)), all_kinds());
}

TEST_F(DeviceLight, AgreesWithTheProcessorBehindPanesAndMasks) {
  expect_processor_agrees(alpha_room(), all_kinds());
}

TEST_F(DeviceLight, AgreesWithTheProcessorWhereWallsRunThroughLumels) {
  expect_processor_agrees(precompute_or_throw(sealed_rooms(0.05), coarse(0.3)),
                          {point_light({1.0, 1.0, 1.0}), point_light({2.3, 0.02, 1.0})});
}

TEST_F(DeviceLight, AgreesWithTheProcessorNextToALamp) {
  const Model model = precompute_or_throw(box_room({}), coarse(0.25));
  for (const double distance : {0.1, 0.01, 0.001})
    expect_processor_agrees(model, {point_light({distance, 1.13, 1.87})});
}

TEST_F(DeviceLight, AgreesWithTheProcessorWithFewRays) {
  expect_processor_agrees(alpha_room(), all_kinds(), 2.0);
  // Elements that a wall runs through keep the patches that are theirs.
  expect_processor_agrees(precompute_or_throw(sealed_rooms(0.05), coarse(0.3)),
                          {point_light({1.0, 1.0, 1.0})}, 2.0);
}

TEST_F(DeviceLight, NumbersOfRaysThatMeanNothingAreRefused) {
  const Model model = precompute_or_throw(box_room({}), coarse(1.0));
  for (const double patches : {0.0, 17.0, std::nan("")}) {
    LightSessionOptions options;
    options.light.patches_per_element = patches;
    const auto made = LightSession::create(device(), model, options);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::usage);
    EXPECT_NE(made.error().message.find("patches_per_element"), std::string::npos) << made.error().message;
  }
}

TEST_F(DeviceLight, AllFluxArrives) {
  const Model model = precompute_or_throw(box_room({}), coarse(0.25));
  LightSession on_device = session(model);
  const DeviceDirectLight found = lit(on_device, {point_light({4.9, 0.1, 3.9}, 7.0)});
  double flux = 0.0;
  for (std::size_t i = 0; i < found.clusters.size(); ++i)
    flux += found.clusters[i].r * model.systems[0].clusters[i].area;
  EXPECT_NEAR(flux, 4.0 * kPi * 7.0, 1e-4 * 4.0 * kPi * 7.0);
}

TEST_F(DeviceLight, AMovedLightGivesTheBitsOfAFullTrace) {
  const Model model = precompute_or_throw(furnished_room({}), coarse(0.2));
  std::vector<Light> lights = all_kinds();
  LightSession moving = session(model);
  std::uint64_t all = 0;
  lit(moving, lights, &all);
  lights[2].position = {1.0, 0.5, 1.0};
  lights[0].intensity = Rgb(20.0, 30.0, 40.0);
  std::uint64_t few = 0;
  const DeviceDirectLight moved = lit(moving, lights, &few);
  LightSession anew = session(model);
  const DeviceDirectLight full = lit(anew, lights);
  EXPECT_EQ(moved.clusters, full.clusters);
  EXPECT_EQ(moved.gather, full.gather);
  // Only the lamp that moved, of short range, costs rays.
  EXPECT_GT(few, 0u);
  EXPECT_LT(few, all / 4);

  std::uint64_t none = 1;
  lights[1].intensity = Rgb(0.0);
  lights.pop_back();
  const DeviceDirectLight dimmed = lit(moving, lights, &none);
  EXPECT_EQ(none, 0u);
  LightSession last = session(model);
  EXPECT_EQ(dimmed.clusters, lit(last, lights).clusters);
}

TEST_F(DeviceLight, SlicesAndFetchDoNotChangeABit) {
  const Model model = alpha_room();
  LightSession whole = session(model);
  const DeviceDirectLight expected = lit(whole, all_kinds());
  LightSessionOptions options;
  options.light.max_dispatch_rays = 1;
  options.light.fetch = MatrixFetch::storage;
  options.max_submit_rays = 5000;
  options.staging_bytes = 2000;
  LightSession sliced = session(model, options);
  const DeviceDirectLight found = lit(sliced, all_kinds());
  EXPECT_EQ(found.clusters, expected.clusters);
  EXPECT_EQ(found.gather, expected.gather);
}

TEST_F(DeviceLight, SystemsOneByOneGiveTheBitsOfAll) {
  PrecomputeOptions small = coarse(0.4);
  small.system_lumels = 300;
  const Model model = precompute_or_throw(rooms_in_a_row({4.0, 3.0, 4.0}), small);
  ASSERT_GE(model.systems.size(), 2u);
  const std::vector<Light> lights{point_light({1.5, 2.2, 1.7}), point_light({5.5, 1.0, 1.0}),
                                  sun({0.3, -1, 0.2})};
  LightSession whole = session(model);
  const DeviceDirectLight expected = lit(whole, lights);
  DeviceDirectLight found;
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    LightSessionOptions options;
    options.light.systems = {s};
    LightSession part = session(model, options);
    const DeviceDirectLight of_system = lit(part, lights);
    found.clusters.insert(found.clusters.end(), of_system.clusters.begin(), of_system.clusters.end());
    found.gather.insert(found.gather.end(), of_system.gather.begin(), of_system.gather.end());
  }
  EXPECT_EQ(found.clusters, expected.clusters);
  EXPECT_EQ(found.gather, expected.gather);

  const auto in_turn = direct_light_on_device(device(), model, lights, {.max_elements = 1});
  ASSERT_TRUE(in_turn) << in_turn.error().message;
  EXPECT_EQ(in_turn->clusters, expected.clusters);
  EXPECT_EQ(in_turn->gather, expected.gather);
  const auto dark = direct_light_on_device(device(), model, {});
  ASSERT_TRUE(dark) << dark.error().message;
  EXPECT_EQ(dark->clusters, std::vector<Rgb>(expected.clusters.size(), Rgb(0.0)));
  EXPECT_EQ(dark->gather, std::vector<Rgb>(expected.gather.size(), Rgb(0.0)));
}

TEST_F(DeviceLight, AMaskTakesTheShareThatTheHostSays) {
  const Model model = precompute_or_throw(box_room({}), coarse(0.3));
  LightSession traced = session(model);
  const std::vector<Light> lights{point_light({2, 1, 2}), point_light({3, 2, 1})};
  const DeviceDirectLight open = lit(traced, {lights[1]});  // nothing stands in the room
  LightSessionOptions options;
  options.light.visibility = LightVisibility::mask;
  LightSession masked = session(model, options);
  std::vector<float> mask(2 * open.clusters.size(), 0.0f);
  for (std::size_t i = 0; i < open.clusters.size(); ++i)
    mask[open.clusters.size() + i] = i % 2 == 0 ? 1.0f : 0.25f;
  ASSERT_TRUE(masked.write_mask(mask));
  const DeviceDirectLight found = lit(masked, lights);
  for (std::size_t i = 0; i < open.clusters.size(); ++i) {
    const double expected = open.clusters[i].r * (i % 2 == 0 ? 1.0 : 0.25);
    EXPECT_NEAR(found.clusters[i].r, expected, 1e-5 * expected) << i;
  }
}

}  // namespace
}  // namespace relume::test
