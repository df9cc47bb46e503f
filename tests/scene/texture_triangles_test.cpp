// SPDX-License-Identifier: MIT
#include "scene/texture_triangles.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

/// One triangle of each of three materials, with texture coordinates (0,0) (1,0) (0,1) in both sets.
Scene three_triangles() {
  Scene scene;
  scene.vertices.uv0 = {{0, 0}, {1, 0}, {0, 1}};
  scene.vertices.uv1 = {{0, 0}, {0.5, 0}, {0, 0.5}};
  scene.vertices.positions.resize(3);
  scene.materials.resize(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    scene.triangles.push_back({0, 1, 2});
    scene.surfaces.push_back({0, i, i, 1, true, true, false});
  }
  return scene;
}

TEST(TextureTriangles, ListThoseWithATextureOrAPossibleEmitter) {
  Scene scene = three_triangles();
  scene.materials[1].base_color_texture = TextureUse{0, 1};
  const auto listed = texture_triangles(scene, {false, false, true});
  ASSERT_EQ(listed.size(), 2u);
  EXPECT_EQ(listed[0], (TextureTriangle{1, {glm::vec2{0, 0}, glm::vec2{0.5, 0}, glm::vec2{0, 0.5}}}));
  EXPECT_EQ(listed[1], (TextureTriangle{2, {glm::vec2{0, 0}, glm::vec2{1, 0}, glm::vec2{0, 1}}}));
}

TEST(TextureTriangles, EmissionGoesBeforeBaseColourAndTransformsCount) {
  Scene scene = three_triangles();
  scene.materials[0].base_color_texture = TextureUse{0, 1};
  TextureUse shifted{0, 0};
  shifted.transform = glm::dmat3(2, 0, 0, 0, 1, 0, 0.25, 0, 1);  // u' = 2 u + 0.25
  scene.materials[0].emission_texture = shifted;
  const auto listed = texture_triangles(scene, {false, false, false});
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_EQ(listed[0].corners[1], glm::vec2(2.25f, 0.0f));
}

TEST(TextureTriangles, WithoutCoordinatesThereIsNoPlace) {
  Scene scene = three_triangles();
  scene.surfaces[2].has_uv0 = false;
  EXPECT_TRUE(texture_triangles(scene, {false, false, true}).empty());
}

}  // namespace
}  // namespace relume
