// SPDX-License-Identifier: MIT
#include "compute/material_pass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "compute/pass_fixture.h"
#include "support/quad_model.h"

namespace relume::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Clusters 0 and 1 of material 0, cluster 2 of material 1.
Model three_clusters() {
  Model model;
  model.materials = {{"paint", false, false}, {"lamp", false, true}};
  for (int i = 0; i < 3; ++i) add_quad(model, {{i, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 1);
  std::vector<Cluster>& clusters = model.systems[0].clusters;
  clusters[0].albedo = {0.25f, 0.5f, 0.75f};
  clusters[1].albedo = {0.5f, 0.0f, 0.125f};
  clusters[2].albedo = {0.0f, 0.0f, 0.0f};
  clusters[2].exitance = {8.0f, 4.0f, 2.0f};
  clusters[2].material = 1;
  return model;
}

class MaterialPassTest : public PassTest {
 protected:
  struct Colors {
    std::vector<Rgb> albedo;
    std::vector<Rgb> exitance;
  };

  /// After one pass; without states, those of material_data.
  Colors after(const MaterialPassOptions& options, const std::vector<kernels::MaterialState>& states = {}) {
    const Model model = three_clusters();
    auto pass = MaterialPass::create(device().host(), model, 0, options);
    EXPECT_TRUE(pass) << pass.error().message;
    if (!pass) return {};
    const std::vector<BufferRange> ranges = allocate(pass->buffers());
    const ClusterColorRanges colors{allocate("albedo", 3 * 16), allocate("exitance", 3 * 16)};
    const auto bound = pass->bind(ranges, colors);
    EXPECT_TRUE(bound) << bound.error().message;
    upload(ranges, material_data(model, 0, options.states));
    if (!states.empty()) upload(ranges[1], states);
    EXPECT_TRUE(device().submit([&](VkCommandBuffer commands) { pass->record(commands); }));
    return {read_rgb(colors.albedo), read_rgb(colors.exitance)};
  }
};

TEST_F(MaterialPassTest, LeavesEverythingAsStored) {
  const Colors colors = after({});
  EXPECT_THAT(colors.albedo, ElementsAre(Rgb(0.25, 0.5, 0.75), Rgb(0.5, 0.0, 0.125), Rgb(0.0)));
  EXPECT_THAT(colors.exitance, ElementsAre(Rgb(0.0), Rgb(0.0), Rgb(8.0, 4.0, 2.0)));
}

// A new wall colour is that of all of its clusters; a new lamp of 2 cd/m2 leaves pi x 2 lm/m2, whatever its
// albedo.
TEST_F(MaterialPassTest, ReplacesByMaterial) {
  const Colors colors =
      after({}, {replaced_material(Rgb(0.5, 0.25, 0.0), {}), replaced_material({}, Rgb(2.0, 0.0, 1.0))});
  EXPECT_THAT(colors.albedo, ElementsAre(Rgb(0.5, 0.25, 0.0), Rgb(0.5, 0.25, 0.0), Rgb(0.0)));
  EXPECT_EQ(colors.exitance[0], Rgb(0.0));
  EXPECT_NEAR(colors.exitance[2].x, 6.2831853, 1e-6);
  EXPECT_EQ(colors.exitance[2].y, 0.0);
  EXPECT_NEAR(colors.exitance[2].z, 3.1415927, 1e-6);
}

// A factor keeps what a texture made of the wall: its clusters still differ.
TEST_F(MaterialPassTest, ScalesWhatIsStored) {
  const Colors colors =
      after({}, {scaled_material(Rgb(0.5, 1.0, 2.0), Rgb(1.0)), scaled_material(Rgb(1.0), Rgb(0.25))});
  EXPECT_THAT(colors.albedo,
              ElementsAre(Rgb(0.125, 0.5, Rgb::value_type(0.95f)), Rgb(0.25, 0.0, 0.25), Rgb(0.0)));
  EXPECT_EQ(colors.exitance[2], Rgb(2.0, 1.0, 0.5));
}

TEST_F(MaterialPassTest, TakesStatesPerCluster) {
  const Colors colors = after(
      {.states = StatePer::cluster},
      {replaced_material({}, {}), replaced_material(Rgb(0.75), {}), replaced_material(Rgb(0.25), Rgb(0.0))});
  EXPECT_THAT(colors.albedo, ElementsAre(Rgb(0.25, 0.5, 0.75), Rgb(0.75), Rgb(0.25)));
  EXPECT_THAT(colors.exitance, ElementsAre(Rgb(0.0), Rgb(0.0), Rgb(0.0)));
}

TEST_F(MaterialPassTest, ClampsAlbedoAndRefusesToSpreadNonsense) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Colors colors =
      after({.max_albedo = 0.5}, {replaced_material(Rgb(1.0, nan, -1.0), Rgb(nan, -2.0, infinity)),
                                  scaled_material(Rgb(nan), Rgb(-1.0, infinity, 1.0))});
  EXPECT_EQ(colors.albedo[0], Rgb(0.5, 0.0, 0.0));
  EXPECT_EQ(colors.exitance[0], Rgb(0.0, 0.0, double{kernels::kLargestExitance}));
  EXPECT_EQ(colors.albedo[2], Rgb(0.0));
  EXPECT_EQ(colors.exitance[2], Rgb(0.0, double{kernels::kLargestExitance}, 2.0));
}

TEST_F(MaterialPassTest, RefusesWhatDoesNotFit) {
  auto pass = MaterialPass::create(device().host(), three_clusters(), 0, {});
  ASSERT_TRUE(pass) << pass.error().message;
  const std::vector<BufferRange> ranges = allocate(pass->buffers());
  const auto bound = pass->bind(ranges, {allocate("albedo", 48), allocate("exitance", 32)});
  ASSERT_FALSE(bound);
  EXPECT_THAT(bound.error().message, HasSubstr("'exitance' needs 48 bytes"));
  Model empty;
  empty.systems.emplace_back().name = "nothing";
  EXPECT_FALSE(MaterialPass::create(device().host(), empty, 0, {}));
}

}  // namespace
}  // namespace relume::test
