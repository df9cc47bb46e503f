// SPDX-License-Identifier: MIT
//
// Systems split in space: drawn charts, and rooms.
#include "precompute/split_systems.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "precompute/atlas.h"
#include "support/rooms_in_a_row.h"

namespace relume::test {
namespace {

using Parts = std::vector<std::vector<std::uint32_t>>;

/// A chart of 10 lumels, 1 m wide at `x`.
ChartCost chart_at(float x, std::uint64_t lumels = 10) {
  return {{x - 0.5f, 0, 0}, {x + 0.5f, 1, 1}, lumels, double(lumels)};
}

std::vector<std::uint32_t> all_of(const std::vector<ChartCost>& charts) {
  std::vector<std::uint32_t> all;
  for (std::uint32_t c = 0; c < charts.size(); ++c) all.push_back(c);
  return all;
}

TEST(SplitCharts, LeavesWhatFits) {
  const std::vector<ChartCost> charts{chart_at(0), chart_at(1)};
  EXPECT_EQ(split_charts(charts, {}, {0, 1}, 20), (Parts{{0, 1}}));
}

TEST(SplitCharts, HalvesByCostWhereNothingSeesAnything) {
  const std::vector<ChartCost> charts{chart_at(3), chart_at(0), chart_at(2), chart_at(1)};
  EXPECT_EQ(split_charts(charts, {}, all_of(charts), 20), (Parts{{1, 3}, {0, 2}}));
}

TEST(SplitCharts, CutsWhereLeastFluxCrosses) {
  // Five in a row; the first two, and the last three, see each other well. The middle would be 2 | 3 or 3
  // | 2.
  const std::vector<ChartCost> charts{chart_at(0), chart_at(1), chart_at(2), chart_at(3), chart_at(4)};
  const std::vector<ChartLink> links{{0, 1, 1.0}, {1, 2, 0.1}, {2, 3, 1.0}, {3, 4, 1.0}};
  EXPECT_EQ(split_charts(charts, links, all_of(charts), 30), (Parts{{0, 1}, {2, 3, 4}}));
  const std::vector<ChartLink> other{{0, 1, 1.0}, {1, 2, 1.0}, {2, 3, 0.1}, {3, 4, 1.0}};
  EXPECT_EQ(split_charts(charts, other, all_of(charts), 30), (Parts{{0, 1, 2}, {3, 4}}));
}

TEST(SplitCharts, AWideChartGoesWhereItSeesMore) {
  // Chart 4 reaches over both rooms; its middle is in the left one, but it sees the right one.
  std::vector<ChartCost> charts{chart_at(0), chart_at(1), chart_at(5), chart_at(6), chart_at(2)};
  charts[4].lower.x = 0.0f;
  charts[4].upper.x = 5.8f;
  const std::vector<ChartLink> links{{0, 1, 1.0}, {0, 4, 0.1}, {1, 4, 0.1},
                                     {2, 3, 1.0}, {2, 4, 0.5}, {3, 4, 0.5}};
  EXPECT_EQ(split_charts(charts, links, all_of(charts), 30), (Parts{{0, 1}, {2, 3, 4}}));
}

TEST(SplitCharts, ALargeChartStandsAloneAndSmallPartsFindAPartner) {
  const std::vector<ChartCost> charts{chart_at(0), chart_at(1, 500), chart_at(2), chart_at(3)};
  EXPECT_EQ(split_charts(charts, {{0, 1, 5.0}, {1, 2, 5.0}}, all_of(charts), 100), (Parts{{0, 2, 3}, {1}}));
  EXPECT_EQ(split_charts({chart_at(0, 500)}, {}, {0}, 100), (Parts{{0}}));
}

TEST(SplitCharts, EveryChartIsInOnePart) {
  std::vector<ChartCost> charts;
  std::vector<ChartLink> links;
  for (std::uint32_t c = 0; c < 200; ++c) {
    charts.push_back(chart_at(float(c * 37 % 101), 1 + c % 13));
    if (c > 0) links.push_back({c * 29 % c, c, 0.1 * (c % 7)});
  }
  const Parts parts = split_charts(charts, links, all_of(charts), 60);
  std::vector<std::uint32_t> found;
  for (const auto& part : parts) {
    std::uint64_t lumels = 0;
    for (const auto c : part) lumels += charts[c].lumels, found.push_back(c);
    EXPECT_LE(lumels, 60u);
    EXPECT_TRUE(std::is_sorted(part.begin(), part.end()));
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, all_of(charts));
}

TEST(SplitSystems, CutsFallOnWalls) {
  // 24 lumels a metre of length and more: no two rooms fit a system, and halves would cut through one.
  const Scene scene = rooms_in_a_row({4.0, 3.0, 5.0});
  const Geometry geometry = make_geometry(scene);
  const RayCaster caster = *RayCaster::create(geometry.positions, geometry.triangles);
  std::vector<std::string> warnings;
  const auto charts = make_charts(scene, geometry, 0.25, warnings);
  SystemLimits limits;
  limits.lumels = 1600;
  const auto layouts = lay_out_systems(scene, geometry, charts, caster, limits, warnings);
  ASSERT_TRUE(layouts) << layouts.error().message;
  ASSERT_EQ(layouts->size(), 3u);
  for (const AtlasLayout& layout : *layouts) {
    std::map<std::string, int> rooms;
    for (const auto c : layout.charts) ++rooms[scene.nodes[charts[c].node].path.substr(0, 5)];
    std::erase_if(rooms, [](const auto& room) { return room.first.starts_with("door"); });
    ASSERT_EQ(rooms.size(), 1u);
    EXPECT_EQ(rooms.begin()->second, 6) << rooms.begin()->first;
  }
  EXPECT_TRUE(warnings.empty());
}

// The light of a triangle, seen from either side, is in one lightmap.
TEST(SplitSystems, BothSidesOfATriangleAreInOne) {
  Scene scene = rooms_in_a_row({4.0, 3.0, 5.0});
  for (SceneMaterial& material : scene.materials) material.double_sided = true;
  const Geometry geometry = make_geometry(scene);
  const RayCaster caster = *RayCaster::create(geometry.positions, geometry.triangles);
  std::vector<std::string> warnings;
  const auto charts = make_charts(scene, geometry, 0.25, warnings);
  SystemLimits limits;
  limits.lumels = 500;
  const auto layouts = lay_out_systems(scene, geometry, charts, caster, limits, warnings);
  ASSERT_TRUE(layouts) << layouts.error().message;
  EXPECT_GT(layouts->size(), 5u);
  std::vector<std::size_t> system(geometry.triangles.size(), layouts->size());
  std::size_t second_sides = 0;
  for (std::size_t s = 0; s < layouts->size(); ++s) {
    for (const auto c : (*layouts)[s].charts) {
      for (const auto triangle : charts[c].triangles) {
        second_sides += system[triangle] != layouts->size() ? 1 : 0;
        if (system[triangle] == layouts->size()) system[triangle] = s;
        EXPECT_EQ(system[triangle], s) << triangle;
      }
    }
  }
  EXPECT_GT(second_sides, geometry.triangles.size() / 2);
}

TEST(SplitSystems, NamedPartsAreNumberedAndUnnamedOnesAvoidNamesOfTheScene) {
  Scene scene = rooms_in_a_row({4.0, 4.0, 4.0});
  for (SceneNode& node : scene.nodes) {
    if (node.path.starts_with("room0") || node.path.starts_with("room1")) node.extras.system = "west";
  }
  for (SceneNode& node : scene.nodes) {
    if (node.path == "room2/floor") node.extras.system = "system0";
  }
  const Geometry geometry = make_geometry(scene);
  const RayCaster caster = *RayCaster::create(geometry.positions, geometry.triangles);
  std::vector<std::string> warnings;
  const auto charts = make_charts(scene, geometry, 0.25, warnings);
  SystemLimits limits;
  limits.lumels = 1600;
  const auto layouts = lay_out_systems(scene, geometry, charts, caster, limits, warnings);
  ASSERT_TRUE(layouts);
  std::vector<std::string> names;
  for (const AtlasLayout& layout : *layouts) names.push_back(layout.name);
  EXPECT_EQ(names, (std::vector<std::string>{"system1", "system0", "west#1", "west#2"}));
}

TEST(SplitSystems, LinksAreWhatChartsSeeOfEachOther) {
  // A cube: each face sends 0.2 of its light to each other, so 0.4 m2 between two faces of 1 m2.
  SceneBuilder b;
  b.add_room("cube", b.material("paint", Rgb(0.5)), {0, 0, 0}, {1, 1, 1});
  const Geometry geometry = make_geometry(b.scene());
  const RayCaster caster = *RayCaster::create(geometry.positions, geometry.triangles);
  std::vector<std::string> warnings;
  const auto charts = make_charts(b.scene(), geometry, 0.25, warnings);
  const auto links = link_charts(geometry, charts, caster);
  ASSERT_EQ(links.size(), 15u);
  // 8192 rays each way: sqrt(0.2 x 0.8 / 16384) / 0.2 = 1.6 % if they were random, in five of them.
  for (const ChartLink& link : links) EXPECT_NEAR(link.flux, 0.4, 0.4 * 0.05);
}

}  // namespace
}  // namespace relume::test
