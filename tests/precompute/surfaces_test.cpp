// SPDX-License-Identifier: MIT
//
// Charts, elements and clusters of small scenes whose areas and counts are known by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "precompute/atlas.h"
#include "precompute/charts.h"
#include "precompute/clusters.h"
#include "precompute/elements.h"
#include "precompute/geometry.h"
#include "precompute/precompute.h"
#include "precompute/views.h"
#include "support/scene_builder.h"

namespace relume {
namespace {

using test::SceneBuilder;

/// All that leads up to clusters.
struct Surfaces {
  Surfaces(const Scene& scene, double texel_size, double cluster_size)
      : geometry(make_geometry(scene)),
        caster(*make_caster(geometry)),
        charts(make_charts(scene, geometry, texel_size, warnings)),
        layout(lay_out_systems(scene, geometry, charts, caster, {}, warnings)->front()),
        views(geometry, caster),
        surface(make_elements(geometry, charts, layout, views)),
        cluster(make_clusters(geometry, charts, layout, surface, caster, texel_sizes(scene, texel_size),
                              {cluster_size, 0.0, {}})) {}

  std::map<std::uint32_t, double> cluster_areas(std::uint32_t node) const {
    std::map<std::uint32_t, double> areas;
    for (std::size_t e = 0; e < cluster.size(); ++e) {
      if (charts[surface.elements[e].chart].node == node) areas[cluster[e]] += surface.elements[e].area;
    }
    return areas;
  }

  std::vector<std::string> warnings;
  Geometry geometry;
  RayCaster caster;
  std::vector<Chart> charts;
  AtlasLayout layout;
  Views views;
  SystemSurface surface;
  std::vector<std::uint32_t> cluster;
};

std::array<glm::dvec3, 4> floor_quad(double x0, double z0, double x1, double z1, double y = 0.0) {
  return {glm::dvec3(x0, y, z0), glm::dvec3(x0, y, z1), glm::dvec3(x1, y, z1), glm::dvec3(x1, y, z0)};
}

/// A floor of `cells` x `cells` quads: the same surface, finely tessellated.
std::uint32_t add_tessellated_floor(SceneBuilder& builder, std::uint32_t material, double size, int cells) {
  Scene& scene = builder.scene();
  const std::uint32_t node =
      builder.add_quad("dense", material, floor_quad(0, 0, size / cells, size / cells));
  for (int i = 1; i < cells * cells; ++i) {
    const double x = size * (i % cells) / cells, z = size * (i / cells) / cells, s = size / cells;
    const auto first = std::uint32_t(scene.vertices.positions.size());
    for (const auto& corner : floor_quad(x, z, x + s, z + s)) {
      scene.vertices.positions.push_back(corner);
      scene.vertices.uv0.emplace_back(0.0f);
      scene.vertices.uv1.emplace_back(0.0f);
      scene.vertices.colors.emplace_back(1.0f);
    }
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.triangles.push_back({first, first + 2, first + 3});
    scene.surfaces.back().triangle_count += 2;
  }
  return node;
}

TEST(Charts, AQuadIsCutIntoWholeLumels) {
  SceneBuilder builder;
  builder.add_quad("floor", builder.material("m", Rgb(0.5)), floor_quad(0, 0, 2.0, 1.03));
  const Surfaces s(builder.scene(), 0.1, 0.5);
  ASSERT_EQ(s.charts.size(), 1u);
  EXPECT_EQ(std::max(s.charts[0].width, s.charts[0].height), 20u);
  EXPECT_EQ(std::min(s.charts[0].width, s.charts[0].height), 10u);
  ASSERT_EQ(s.surface.elements.size(), 200u);
  for (const Element& e : s.surface.elements) EXPECT_NEAR(e.area, 2.0 * 1.03 / 200.0, 1e-6);
}

TEST(Charts, AWallWithADoorLiesAlongItsBorders) {
  // 4 m x 2 m, the door 1 m x 1.5 m; no triangle is half of a rectangle, and the longest edges run aslant.
  SceneBuilder builder;
  builder.add_triangles(
      "wall", builder.material("m", Rgb(0.5)),
      {{0, 0, 0}, {1.5, 0, 0}, {1.5, 1.5, 0}, {2.5, 1.5, 0}, {2.5, 0, 0}, {4, 0, 0}, {4, 2, 0}, {0, 2, 0}},
      {{0, 1, 2}, {0, 2, 7}, {2, 3, 7}, {3, 6, 7}, {3, 4, 6}, {4, 5, 6}});
  const Surfaces s(builder.scene(), 0.1, 0.5);
  ASSERT_EQ(s.charts.size(), 1u);
  EXPECT_EQ(std::max(s.charts[0].width, s.charts[0].height), 40u);
  EXPECT_EQ(std::min(s.charts[0].width, s.charts[0].height), 20u);
  EXPECT_EQ(s.surface.elements.size(), 800u - 150u);
}

TEST(Charts, EachFaceOfABoxHasItsOwn) {
  SceneBuilder builder;
  builder.add_box("box", builder.material("m", Rgb(0.5)), {0, 0, 0}, {1, 1, 1},
                  SceneBuilder::Facing::outward);
  const Surfaces s(builder.scene(), 0.25, 0.5);
  EXPECT_EQ(s.charts.size(), 6u);
  EXPECT_EQ(s.surface.elements.size(), 6u * 16u);
}

TEST(Charts, BothSidesOfADoubleSidedSurface) {
  SceneBuilder builder;
  builder.add_quad("sheet", builder.material("m", Rgb(0.5), Rgb(0.0), true), floor_quad(0, 0, 1, 1));
  const Surfaces s(builder.scene(), 0.25, 0.5);
  ASSERT_EQ(s.charts.size(), 2u);
  EXPECT_EQ(s.charts[1].side, Side::back);
  for (const Element& e : s.surface.elements)
    EXPECT_FLOAT_EQ(e.normal.y, s.charts[e.chart].side == Side::front ? 1.0f : -1.0f);
}

TEST(Charts, AnOverlappingLightmapUvIsRefusedByName) {
  SceneBuilder builder;
  builder.add_box("crate", builder.material("m", Rgb(0.5)), {0, 0, 0}, {1, 1, 1},
                  SceneBuilder::Facing::outward);
  Scene& scene = builder.scene();
  scene.surfaces[0].has_uv1 = true;
  constexpr std::array<glm::vec2, 4> kCorners{glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1),
                                              glm::vec2(0, 1)};
  for (std::size_t v = 0; v < scene.vertices.uv1.size(); ++v) scene.vertices.uv1[v] = kCorners[v % 4];
  const Surfaces s(scene, 0.25, 0.5);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_NE(s.warnings[0].find("crate: TEXCOORD_1 overlaps itself"), std::string::npos) << s.warnings[0];
  EXPECT_EQ(s.charts.size(), 6u);
}

TEST(Charts, AValidLightmapUvIsUsed) {
  SceneBuilder builder;
  builder.add_quad("floor", builder.material("m", Rgb(0.5)), floor_quad(0, 0, 2, 2));
  Scene& scene = builder.scene();
  scene.surfaces[0].has_uv1 = true;
  scene.vertices.uv1 = {{0.25f, 0.25f}, {0.75f, 0.25f}, {0.75f, 0.75f}, {0.25f, 0.75f}};
  const Surfaces s(scene, 0.5, 1.0);
  ASSERT_EQ(s.charts.size(), 1u);
  EXPECT_EQ(s.charts[0].uv_set, 1u);
  EXPECT_FLOAT_EQ(s.charts[0].uv_scale.x, 8.0f);  // 2 m over half of the unit square, four lumels
  EXPECT_EQ(s.surface.elements.size(), 16u);
}

TEST(Elements, AreasAddUpToTheSurface) {
  SceneBuilder builder;
  builder.add_room("room", builder.material("m", Rgb(0.5)), {0, 0, 0}, {3, 2, 4});
  const Surfaces s(builder.scene(), 0.13, 0.5);
  double area = 0.0;
  for (const Element& e : s.surface.elements) area += e.area;
  EXPECT_NEAR(area, 2.0 * (3 * 2 + 3 * 4 + 2 * 4), 1e-4);
}

/// A floor of 4 x 4 m that runs under a wall across its middle, `thickness` thick, high and wide enough that
/// nothing sees around it.
void add_walled_floor(SceneBuilder& builder, double offset, double thickness) {
  const auto m = builder.material("m", Rgb(0.5));
  builder.add_quad("floor", m, floor_quad(0, 0, 4, 4));
  builder.add_box("wall", m, {offset, -0.5, -1}, {offset + thickness, 3, 5}, SceneBuilder::Facing::outward);
}

struct Wall {
  double at, thickness;
};

class WalledFloor : public testing::TestWithParam<Wall> {};

TEST_P(WalledFloor, NoElementLinkOrClusterLiesOnBothSides) {
  SceneBuilder builder;
  const Wall wall = GetParam();
  add_walled_floor(builder, wall.at, wall.thickness);
  const Surfaces s(builder.scene(), 0.1, 0.5);
  const auto side_of = [&](const Element& e) {
    return e.position.x < wall.at ? -1 : (e.position.x > wall.at + wall.thickness ? 1 : 0);
  };
  std::map<std::uint32_t, int> side_of_cluster;
  bool left = false, right = false;
  for (std::size_t e = 0; e < s.surface.elements.size(); ++e) {
    if (s.charts[s.surface.elements[e].chart].node != 0) continue;
    const int side = side_of(s.surface.elements[e]);
    left = left || side < 0;
    right = right || side > 0;
    const auto [known, inserted] = side_of_cluster.insert({s.cluster[e], side});
    EXPECT_EQ(known->second, side) << "cluster " << s.cluster[e];
  }
  EXPECT_TRUE(left && right);
  for (const auto& [a, b] : s.surface.links) {
    if (s.charts[s.surface.elements[a].chart].node != 0) continue;
    EXPECT_EQ(side_of(s.surface.elements[a]), side_of(s.surface.elements[b]));
  }
}

// In lumels: a quarter, a half, a tenth and a hundredth; and two. And in the last lumel of the floor, which
// has no neighbour behind the wall.
INSTANTIATE_TEST_SUITE_P(Walls, WalledFloor,
                         testing::Values(Wall{2.03, 0.025}, Wall{2.03, 0.05}, Wall{2.03, 0.01},
                                         Wall{2.03, 0.001}, Wall{2.03, 0.2}, Wall{3.965, 0.01},
                                         Wall{0.02, 0.001}));

// Its lumel is seen from all sides of it, and stays whole.
TEST(Elements, APostOnTheEdgeOfAFloorCutsNothing) {
  SceneBuilder builder;
  const auto m = builder.material("m", Rgb(0.5));
  builder.add_quad("floor", m, floor_quad(0, 0, 1, 1));
  const Surfaces bare(builder.scene(), 0.25, 0.5);
  builder.add_standing_box("post", m, {0.05, 0, 0.05}, {0.08, 2, 0.08});
  const Surfaces posted(builder.scene(), 0.25, 0.5);
  std::size_t floor = 0, walled = 0;
  for (const Element& e : posted.surface.elements) {
    if (posted.charts[e.chart].node == 0) ++floor, walled += e.walled ? 1 : 0;
  }
  EXPECT_EQ(floor, bare.surface.elements.size());
  EXPECT_EQ(walled, 0u);
}

TEST(Clusters, TwoTrianglesAreCut) {
  SceneBuilder builder;
  const auto node = builder.add_quad("floor", builder.material("m", Rgb(0.5)), floor_quad(0, 0, 4, 2));
  const Surfaces s(builder.scene(), 0.125, 0.5);
  const auto areas = s.cluster_areas(node);
  EXPECT_EQ(areas.size(), 32u);
  for (const auto& [c, area] : areas) EXPECT_NEAR(area, 0.25, 1e-5);
}

TEST(Clusters, TessellationDoesNotMatter) {
  SceneBuilder builder;
  const auto node = add_tessellated_floor(builder, builder.material("m", Rgb(0.5)), 2.0, 40);
  const Surfaces s(builder.scene(), 0.125, 0.5);
  const auto areas = s.cluster_areas(node);
  EXPECT_EQ(areas.size(), 16u);
  for (const auto& [c, area] : areas) EXPECT_NEAR(area, 0.25, 1e-5);
}

TEST(Clusters, MaterialsDoNotMix) {
  SceneBuilder builder;
  const auto a = builder.material("a", Rgb(0.5)), b = builder.material("b", Rgb(0.2));
  builder.add_quad("left", a, floor_quad(0, 0, 0.3, 0.3));
  builder.add_quad("right", b, floor_quad(0.3, 0, 0.6, 0.3));
  const Surfaces s(builder.scene(), 0.1, 1.0);
  std::map<std::uint32_t, std::uint32_t> material;
  for (std::size_t e = 0; e < s.cluster.size(); ++e) {
    const auto [known, inserted] = material.insert({s.cluster[e], s.surface.elements[e].material});
    EXPECT_EQ(known->second, s.surface.elements[e].material);
  }
  EXPECT_EQ(material.size(), 2u);
}

TEST(Systems, FollowTheExtras) {
  SceneBuilder builder;
  const auto m = builder.material("m", Rgb(0.5));
  builder.add_quad("a", m, floor_quad(0, 0, 1, 1));
  builder.add_quad("b", m, floor_quad(2, 0, 3, 1));
  builder.scene().nodes[0].extras.system = "west";
  builder.scene().nodes[1].extras.system = "east";
  const Geometry geometry = make_geometry(builder.scene());
  std::vector<std::string> warnings;
  const auto charts = make_charts(builder.scene(), geometry, 0.25, warnings);
  const RayCaster caster = *RayCaster::create(geometry.positions, geometry.triangles);
  const auto layouts = lay_out_systems(builder.scene(), geometry, charts, caster, {}, warnings);
  ASSERT_TRUE(layouts);
  ASSERT_EQ(layouts->size(), 2u);
  EXPECT_EQ((*layouts)[0].name, "east");
  EXPECT_EQ((*layouts)[1].name, "west");
}

TEST(Lumels, ThatSeeTheBackOfACeilingAreToldOf) {
  SceneBuilder builder;
  const auto material = builder.material("m", Rgb(0.5));
  builder.add_quad("floor", material, floor_quad(0, 0, 2, 2));
  builder.add_quad("roof", material, floor_quad(-5, -5, 7, 7, 0.3));
  PrecomputeOptions options;
  options.texel_size = options.cluster_size = 0.5;
  options.quality = 64;
  PrecomputeReport report;
  ASSERT_TRUE(precompute(builder.scene(), options, report));
  const auto told = [](const std::string& w) { return w.find("backs of surfaces") != std::string::npos; };
  EXPECT_EQ(std::count_if(report.warnings.begin(), report.warnings.end(), told), 0);  // 16 of 592 lumels
  builder.scene().nodes[1].extras.receiver = "clusters";
  PrecomputeReport floor_alone;
  ASSERT_TRUE(precompute(builder.scene(), options, floor_alone));
  const auto warning = std::find_if(floor_alone.warnings.begin(), floor_alone.warnings.end(), told);
  ASSERT_NE(warning, floor_alone.warnings.end());
  EXPECT_NE(warning->find("16 of 16 lumels"), std::string::npos) << *warning;
  EXPECT_NE(warning->find("on floor"), std::string::npos) << *warning;
}

TEST(Systems, ChartsDoNotTouchInTheLightmap) {
  SceneBuilder builder;
  builder.add_room("room", builder.material("m", Rgb(0.5)), {0, 0, 0}, {3, 2, 4});
  const Surfaces s(builder.scene(), 0.2, 0.5);
  std::map<std::pair<int, int>, std::uint32_t> chart_at;
  for (const Element& e : s.surface.elements)
    chart_at[{int(e.cell % s.surface.width), int(e.cell / s.surface.width)}] = e.chart;
  for (const auto& [at, chart] : chart_at) {
    for (int step = 0; step < 25; ++step) {
      const auto near = chart_at.find({at.first + step % 5 - 2, at.second + step / 5 - 2});
      EXPECT_TRUE(near == chart_at.end() || near->second == chart);
    }
  }
}

}  // namespace
}  // namespace relume
