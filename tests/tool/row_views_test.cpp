// SPDX-License-Identifier: MIT
#include "tool/row_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/tiny_model.h"

namespace relume::test {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

TEST(RowViews, FormFactorsArePerAreaAndOfClustersAlone) {
  Model model = tiny_model();
  model.systems[1].clusters[0].area = 4.0f;
  // The lumel of the floor sees the lid with 0.2 and the sky with 0.5.
  EXPECT_THAT(form_factor_densities(model, {0, 0, 0.0}), ElementsAre(0.0, 1.0));
}

TEST(RowViews, LengthsAreRelativeToTheLongestRow) {
  EXPECT_THAT(relative_row_lengths(tiny_model(), 0), ElementsAre(1.0, 0.5));
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
}

TEST(RowViews, TheNearestLumelIsOnTheNearestSurface) {
  const Model model = tiny_model();
  const ChosenLumel near_lid = nearest_lumel(model, model.origin + glm::dvec3(0.5, 0.9, 0.5));
  EXPECT_EQ(near_lid.system, 1u);
  EXPECT_EQ(nearest_lumel(model, model.origin + glm::dvec3(0.5, 0.1, 0.5)).system, 0u);
}

}  // namespace
}  // namespace relume::test
