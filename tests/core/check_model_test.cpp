// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/model.h"
#include "support/tiny_model.h"

namespace relume {
namespace {

struct Breakage {
  std::function<void(Model&)> breaker;
  const char* part;  ///< of the message
};

const float kNotANumber = std::nanf("");

void expect_refused(const std::vector<Breakage>& breakages) {
  for (const Breakage& breakage : breakages) {
    Model model = test::tiny_model();
    breakage.breaker(model);
    const auto checked = check_model(model);
    ASSERT_FALSE(checked) << breakage.part;
    EXPECT_EQ(checked.error().code, ErrorCode::check_failed);
    EXPECT_NE(checked.error().message.find(breakage.part), std::string::npos) << checked.error().message;
  }
}

TEST(CheckModel, AcceptsTheTinyModelAndAnEmptyOne) {
  EXPECT_TRUE(check_model(test::tiny_model())) << check_model(test::tiny_model()).error().message;
  EXPECT_TRUE(check_model(Model{}));
}

TEST(CheckModel, RefusesWhatIsWrongWithTheWhole) {
  expect_refused({
      {[](Model& m) { m.origin.y = std::numeric_limits<double>::infinity(); }, "finite origin"},
      {[](Model& m) { m.max_albedo = 1.0; }, "at most 0.9999, found 1"},
      {[](Model& m) { m.sky_cells[0] = 24; }, "sky patch 0: expected a cell below 24, found 24"},
      {[](Model& m) { m.sky_resolution = 5000; }, "sky resolution"},
      {[](Model& m) { m.sky_radiance->x = -1.0; }, "sky radiance"},
      {[](Model& m) { m.materials[1].name = "paint"; },
       "materials: expected unique names, found 'paint' twice"},
      {[](Model& m) { m.nodes[1].path = "room/floor"; }, "found 'room/floor' twice"},
      {[](Model& m) { m.systems[1].name = "floor"; }, "systems: expected unique names"},
      {[](Model& m) { m.provenance.options.assign((1u << 20) + 1, ' '); },
       "provenance: expected names of at most"},
      {[](Model& m) { m.camera->up = m.camera->forward; }, "camera"},
      {[](Model& m) { m.camera->vertical_field_of_view = 4.0; }, "field of view"},
  });
}

TEST(CheckModel, RefusesBrokenLights) {
  expect_refused({
      {[](Model& m) { m.lights[0].intensity.y = std::nan(""); }, "light 0: expected a finite intensity"},
      {[](Model& m) { m.lights[0].position.y = std::nan(""); }, "light 0: expected a finite position"},
      {[](Model& m) {
         m.lights[2].direction = {0, 0, 0};
       },
       "light 2: expected a direction of length 1"},
      {[](Model& m) { m.lights[1].inner_cone_angle = 0.6; }, "light 1: expected cone angles"},
      {[](Model& m) { m.lights[1].outer_cone_angle = 2.0; }, "light 1: expected cone angles"},
      {[](Model& m) { m.lights[1].range = -1.0; }, "light 1: expected a finite range"},
      {[](Model& m) { m.lights[1].type = LightType{3}; }, "light 1: expected type"},
  });
}

TEST(CheckModel, RefusesBrokenOccluders) {
  expect_refused({
      {[](Model& m) { m.occluders.positions[3].z = kNotANumber; }, "position 3"},
      {[](Model& m) { m.occluders.triangles[2][1] = 8; }, "triangle 2: expected positions below 8, found 8"},
      {[](Model& m) { m.occluders.material[1] = 2; }, "triangle 1: expected a material below 2, found 2"},
      {[](Model& m) { m.occluders.node[1] = 2; }, "triangle 1: expected a node below 2, found 2"},
      {[](Model& m) { m.occluders.system[1] = 2; }, "triangle 1: expected a system below 2, found 2"},
      {[](Model& m) { m.occluders.front_uv.pop_back(); }, "12 lightmap corners"},
      {[](Model& m) { m.occluders.back_uv.pop_back(); }, "12 lightmap corners"},
      {[](Model& m) { m.occluders.front_uv[0].x = kNotANumber; }, "finite lightmap coordinates"},
  });
}

TEST(CheckModel, RefusesBrokenOpacity) {
  expect_refused({
      {[](Model& m) { m.occluders.opacity.maps[0].rule = OpacityRule{2}; },
       "opacity map 0: expected rule 0 or 1"},
      {[](Model& m) { m.occluders.opacity.maps[1].wrap_t = WrapMode{3}; },
       "opacity map 1: expected rule 0 or 1"},
      {[](Model& m) { m.occluders.opacity.maps[0].cutoff = -0.5f; },
       "opacity map 0: expected a finite cutoff"},
      {[](Model& m) { m.occluders.opacity.maps[0].solid = 1.5f; }, "solid share from 0 to 1"},
      {[](Model& m) { m.occluders.opacity.maps[0].width = 0; }, "opacity map 0: expected 0 x 2 texels"},
      {[](Model& m) { m.occluders.opacity.maps[0].height = 3; }, "2 x 3 texels from texel 1 on, found 5"},
      {[](Model& m) { m.occluders.opacity.maps[0].width = m.occluders.opacity.maps[0].height = 0xffffffffu; },
       "opacity map 0: expected 4294967295 x 4294967295 texels"},
      {[](Model& m) { m.occluders.opacity.texels.pop_back(); }, "found 4 texels"},
      {[](Model& m) { m.occluders.opacity.triangles[1].triangle = 4; },
       "ascending triangles below 4, found 4"},
      {[](Model& m) { m.occluders.opacity.triangles[1].triangle = 1; },
       "ascending triangles below 4, found 1"},
      {[](Model& m) { m.occluders.opacity.triangles[0].map = 2; },
       "triangle 1: expected a map below 2, found 2"},
      {[](Model& m) { m.occluders.opacity.triangles[0].corners[2].z = 1.5f; }, "alpha from 0 to 1"},
      {[](Model& m) { m.occluders.opacity.triangles[0].corners[1].x = kNotANumber; },
       "finite texture coordinates"},
  });
}

TEST(CheckModel, RefusesBrokenTextureCoordinates) {
  expect_refused({
      {[](Model& m) { m.occluders.texture[0].triangle = 4; },
       "texture coordinates: expected ascending triangles below 4, found 4"},
      {[](Model& m) { m.occluders.texture.push_back(m.occluders.texture[0]); },
       "texture coordinates: expected ascending triangles below 4, found 2"},
      {[](Model& m) { m.occluders.texture[0].corners[1].y = kNotANumber; },
       "texture coordinates of triangle 2: expected finite numbers"},
  });
}

/// A root over a leaf of the first two triangles and a node over the others.
Model with_two_nodes() {
  Model model = test::tiny_model();
  OccluderBvh& bvh = model.occluders.bvh;
  bvh.nodes.push_back(bvh.nodes[0]);
  bvh.nodes[0].children = {1, bvh_leaf_child({0, 2}), kBvhNoChild, kBvhNoChild};
  bvh.nodes[1].children[0] = bvh_leaf_child({2, 2});
  for (auto& axis : bvh.nodes[0].upper) axis[1] = axis[0];
  return model;
}

TEST(CheckModel, TakesATreeOfTwoNodes) {
  const auto checked = check_model(with_two_nodes());
  EXPECT_TRUE(checked) << checked.error().message;
}

TEST(CheckModel, RefusesABrokenTreeOfOccluders) {
  const auto in_tree = [](void (*change)(OccluderBvh&)) {
    return [change](Model& m) {
      m = with_two_nodes();
      change(m.occluders.bvh);
    };
  };
  expect_refused({
      {in_tree([](OccluderBvh& b) { b.nodes[0].children[0] = 0; }),
       "node 0 of the tree of occluders: expected a child above it"},
      {in_tree([](OccluderBvh& b) { b.nodes[1].children[1] = 0; }),
       "node 1 of the tree of occluders: expected a child above it"},
      {in_tree([](OccluderBvh& b) { b.nodes[0].children[0] = 2; }),
       "and below 2 that has one parent, found 2"},
      {in_tree([](OccluderBvh& b) { b.nodes[0].children[1] = 1; }), "that has one parent, found 1"},
      {in_tree([](OccluderBvh& b) {
         b.nodes[0].children[0] = bvh_leaf_child({2, 2});
       }),
       "found it in two"},
      {in_tree([](OccluderBvh& b) {
         b.nodes[1].children[0] = bvh_leaf_child({3, 2});
       }),
       "expected entries below 4, found 2 from 3 on"},
      {in_tree([](OccluderBvh& b) {
         b.nodes[1].children[0] = bvh_leaf_child({2, 1});
       }),
       "expected entry 3 in a leaf"},
      {in_tree([](OccluderBvh& b) { b.nodes[1].children[0] = kBvhNoChild; }),
       "node 1 of the tree of occluders: expected a child"},
      {in_tree([](OccluderBvh& b) {
         b.nodes[0].children[1] = kBvhNoChild, b.nodes[0].children[2] = bvh_leaf_child({0, 2});
       }),
       "expected no gaps"},
      {in_tree([](OccluderBvh& b) { b.nodes[1].upper[1][0] = 128; }),
       "node 1 of the tree of occluders: expected the box of child 0 around"},
      {in_tree([](OccluderBvh& b) { b.nodes[0].lower[2][1] = 2; }),
       "node 0 of the tree of occluders: expected the box of child 1 around"},
      {in_tree([](OccluderBvh& b) { b.nodes[1].origin.x = kNotANumber; }), "expected a finite origin"},
      {in_tree([](OccluderBvh& b) { b.nodes[1].exponents[1] = 255; }), "exponents from 1 to 254"},
      {in_tree([](OccluderBvh& b) { b.nodes[0].zero[1] = 1; }), "and zeros"},
      {in_tree([](OccluderBvh& b) { b.triangles[1] = 0; }), "each triangle below 4 at most once, found 0"},
      {in_tree([](OccluderBvh& b) { b.triangles[1] = 4; }), "each triangle below 4 at most once, found 4"},
      {in_tree([](OccluderBvh& b) { b = {}; }), "triangle 0 is missing"},
      {in_tree([](OccluderBvh& b) { b.nodes.clear(); }), "expected entry 0 in a leaf"},
  });
}

TEST(CheckModel, RefusesBrokenLightSamples) {
  expect_refused({
      {[](Model& m) { m.systems[0].rays.resize(2); }, "rays of all 1 clusters or of none, found 2"},
      {[](Model& m) {
         m.systems[0].rays = {{64, kNotANumber}};
       },
       "finite estimates"},
      {[](Model& m) { m.systems[0].cut_errors.resize(2); }, "errors of all 1 lumels or of none, found 2"},
      {[](Model& m) { m.systems[0].cut_errors = {-0.5f}; }, "finite estimates"},
      {[](Model& m) { m.systems[0].lifted_sensors.clear(); },
       "system 0: expected 1 finite points where sensors measure, found 0"},
      {[](Model& m) { m.systems[0].lifted_sensors[0].x = kNotANumber; }, "finite points"},
      // Two halves of 0.5 m2 are nine patches each.
      {[](Model& m) { m.systems[0].own_patches = {1u << 18}; }, "a bit for each of 18 light patches"},
      {[](Model& m) {
         m.systems[0].own_patches = {0, 0};
       },
       "found 2 words"},
  });
}

TEST(CheckModel, RefusesBrokenSurfaces) {
  expect_refused({
      {[](Model& m) { m.systems[1].clusters[0].centroid.x = kNotANumber; },
       "system 1, cluster 0: expected a finite centroid"},
      {[](Model& m) { m.systems[0].clusters[0].area = 0.0f; }, "expected an area above 0"},
      {[](Model& m) { m.systems[0].clusters[0].area = 1.01f; }, "area of its elements, 1, found 1.01"},
      {[](Model& m) {
         m.systems[0].clusters[0].normal = {0, 1, 1};
       },
       "normal of length 1"},
      {[](Model& m) { m.systems[0].clusters[0].albedo[1] = 0.96f; }, "albedo from 0 to 0.95"},
      {[](Model& m) { m.systems[0].clusters[0].exitance[2] = -1.0f; }, "exitance"},
      {[](Model& m) { m.systems[0].clusters[0].material = 2; }, "material below 2"},
      {[](Model& m) { m.systems[0].clusters[0].side = Side{2}; }, "side 0 or 1"},
      {[](Model& m) { m.systems[0].clusters[0].element_count = 2; }, "at least one element"},
      {[](Model& m) { m.systems[0].clusters[0].first_element = 1; }, "at least one element"},
      {[](Model& m) { m.systems[0].elements.push_back(m.systems[0].elements[0]); }, "expected 1 elements"},
      {[](Model& m) { m.systems[0].elements[0].cluster = 1; }, "element 0: expected cluster 0, found 1"},
      {[](Model& m) { m.systems[0].elements[0].normal *= 0.9f; }, "element 0: expected a finite position"},
      {[](Model& m) { m.systems[0].elements[0].piece_count = 3; }, "at least one piece"},
      {[](Model& m) { m.systems[0].elements[0].piece_count = 1; }, "expected 1 pieces"},
      {[](Model& m) { m.systems[0].pieces[1].triangle = 4; },
       "piece 1: expected a triangle below 4, found 4"},
      {[](Model& m) { m.systems[0].pieces[1].triangle = 2; }, "of its cluster's system, material and node"},
      {[](Model& m) {
         m.systems[0].pieces[1].corners[1] = {0.8f, 0.3f};
       },
       "corners inside the triangle"},
      {[](Model& m) { m.systems[0].lumels[0].x = 2; }, "lumel 0: expected a texel"},
      {[](Model& m) { m.systems[0].lumels[0].element = 1; }, "element below 1"},
      {[](Model& m) { m.systems[0].lumels[0].flags = 4; }, "known flags"},
      {[](Model& m) { m.systems[0].lumels.push_back(m.systems[0].lumels[0]); }, "found two at (1, 0)"},
      {[](Model& m) { m.systems[0].sensors[0].name = 1; }, "sensor 0"},
      {[](Model& m) { m.systems[0].charts[0].node = 2; }, "chart 0"},
  });
}

TEST(CheckModel, RefusesBrokenImportsAndMatrices) {
  expect_refused({
      {[](Model& m) { m.systems[0].imports[0].system = 2; }, "import 0: expected a system below 2"},
      {[](Model& m) { m.systems[0].imports[0].index = 1; },
       "import 0: expected a cluster or node below 1, found 1"},
      {[](Model& m) { m.systems[0].imports[1].index = 1; },
       "import 1: expected a sky patch or node below 1, found 1"},
      {[](Model& m) {
         m.systems[1].tree = {{{0, 2, 0}}, {0.5f, 0.5f}};
       },
       "system 1, tree node 0: expected at least 2 of 1 leaves"},
      {[](Model& m) {
         m.sky_tree = {{{0, 1, 0}}, {1.0f}};
       },
       "sky, tree node 0: expected at least 2 of 1 leaves"},
      {[](Model& m) {
         m.sky_cells = {8, 9}, m.sky_tree = {{{0, 2, 1}}, {0.5f, 0.5f}};
       },
       "sky, tree node 0: expected 2 shares from 0 on, found them from 1 on of 2"},
      {[](Model& m) {
         m.sky_cells = {8, 9}, m.sky_tree = {{{0, 2, 0}}, {0.5f}};
       },
       "expected 2 shares from 0 on, found them from 0 on of 1"},
      {[](Model& m) {
         m.sky_cells = {8, 9}, m.sky_tree = {{{0, 2, 0}}, {0.5f, 0.75f}};
       },
       "expected shares from 0 to 1 that add up to 1, found 1.25"},
      {[](Model& m) {
         m.sky_cells = {8, 9}, m.sky_tree = {{{0, 2, 0}}, {-0.5f, 1.5f}};
       },
       "expected shares from 0 to 1 that add up to 1, found 1"},
      {[](Model& m) { m.sky_tree.shares = {1.0f}; },
       "sky: expected 0 shares, as the nodes of its tree have leaves, found 1"},
      {[](Model& m) { m.systems[0].imports[1] = m.systems[0].imports[0]; }, "each import once"},
      {[](Model& m) { m.systems[0].imports.pop_back(); },
       "bounce matrix: expected 1 rows and 1 columns, found 1 and 2"},
      {[](Model& m) { m.systems[0].gather = m.systems[0].bounce; }, "gather matrix: expected 2 rows"},
      {[](Model& m) { m.systems[1].gather.blocks[0].row_scales[0] = 6.0f; },
       "model: system 1, gather matrix: block 0: row 0: expected a row sum of at most 1"},
  });
}

TEST(Offsets, NumberThroughAllSystems) {
  const Model model = test::tiny_model();
  EXPECT_EQ(cluster_offsets(model), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(gather_offsets(model), (std::vector<std::uint32_t>{0, 2, 3}));
}

}  // namespace
}  // namespace relume
