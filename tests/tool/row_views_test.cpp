// SPDX-License-Identifier: MIT
#include "tool/row_views.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/tiny_model.h"
#include "tool/lumel_numbers.h"
#include "tool/uv_overlap.h"

namespace relume::test {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsNan;

TEST(RowViews, FormFactorsArePerAreaAndOfClustersAlone) {
  Model model = tiny_model();
  model.systems[1].clusters[0].area = 4.0f;
  // The lumel of the floor sees the lid with 0.2 and the sky with 0.5.
  EXPECT_THAT(form_factor_densities(model, {0, 0, 0.0}), ElementsAre(0.0, DoubleNear(0.05, 1e-5)));
}

TEST(RowViews, LengthsAndSumsAreThoseOfTheRows) {
  EXPECT_THAT(row_lengths(tiny_model(), 0), ElementsAre(2.0, 1.0));
  EXPECT_THAT(row_sums(tiny_model(), 0), ElementsAre(DoubleNear(0.7, 1e-5), DoubleNear(0.25, 1e-5)));
}

TEST(RowViews, LeavesAreNoMeans) {
  EXPECT_THAT(shares_of_nodes(tiny_model(), 0), ElementsAre(0.0, 0.0));
}

TEST(RowViews, ANodeOfTwoPatchesIsAMean) {
  Model model = tiny_model();
  // The second sender of the floor becomes a node of the sky: 0.5 of the 0.7 that its lumel sees.
  model.sky_cells.push_back(model.sky_cells.back() + 1);
  model.sky_tree = {{{0, 2, 0}}, {0.5f, 0.5f}};
  model.systems[0].imports[1] = {kSkySystem, 2};
  EXPECT_THAT(shares_of_nodes(model, 0), ElementsAre(DoubleNear(0.5 / 0.7, 1e-6), 0.0));
  // Two leaves are one level up.
  EXPECT_THAT(tree_levels(model, 0), ElementsAre(DoubleNear(0.5 / 0.7, 1e-6), 0.0));
}

TEST(RowViews, TheNearestLumelIsOnTheNearestSurface) {
  const Model model = tiny_model();
  const ChosenLumel near_lid = nearest_lumel(model, model.origin + glm::dvec3(0.5, 0.9, 0.5));
  EXPECT_EQ(near_lid.system, 1u);
  EXPECT_EQ(nearest_lumel(model, model.origin + glm::dvec3(0.5, 0.1, 0.5)).system, 0u);
}

TEST(UvOverlap, IsTheShareUnderTwoTriangles) {
  // The lumel lies at (1, 0); its triangles are the halves of that texel, or the same half.
  Model model = tiny_model();
  model.systems[0].charts[0].uv_set = 1;
  const std::array<glm::vec2, 6> halves{glm::vec2{1, 0}, glm::vec2{2, 0}, glm::vec2{2, 1},
                                        glm::vec2{1, 0}, glm::vec2{2, 1}, glm::vec2{1, 1}};
  std::copy(halves.begin(), halves.end(), model.occluders.front_uv.begin());
  EXPECT_THAT(uv_overlaps(model, 0), ElementsAre(0.0));
  std::copy_n(halves.begin(), 3, model.occluders.front_uv.begin() + 3);
  EXPECT_THAT(uv_overlaps(model, 0), ElementsAre(1.0));
  model.systems[0].charts[0].uv_set = kNone;
  EXPECT_THAT(uv_overlaps(model, 0), ElementsAre(IsNan()));
}

TEST(LumelNumbers, AreRaysAndEstimatesAsTheModelTells) {
  Model model = tiny_model();
  const auto rays = lumel_numbers(model, "rays", {});
  ASSERT_TRUE(rays);
  EXPECT_THAT(rays->values, ElementsAre(ElementsAre(64.0), ElementsAre(128.0)));
  EXPECT_EQ(rays->white, 128.0);
  EXPECT_EQ(heat_of(*rays, 128.0), 1.0);
  EXPECT_EQ(heat_of(*rays, 1.0), 0.0);  // 7 halvings
  EXPECT_NEAR(heat_of(*rays, 64.0), 6.0 / 7.0, 1e-12);
  const auto error = lumel_numbers(model, "error", {});
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->values[0][0], std::hypot(0.25, 0.75), 1e-6);
  for (System& system : model.systems) system.rays.clear(), system.cut_errors.clear();
  EXPECT_FALSE(lumel_numbers(model, "error", {}));
  EXPECT_FALSE(lumel_numbers(model, "rays", {}));
  model.systems[0].lumels[0].flags = kLumelInvalid;
  EXPECT_THAT(lumel_numbers(model, "row_length", {})->values[0], ElementsAre(IsNan()));
}

}  // namespace
}  // namespace relume::test
