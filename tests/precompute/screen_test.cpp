// SPDX-License-Identifier: MIT
//
// A screen keeps its place in the image: what the precompute stores for an emissive texture comes back from
// the footprint.
#include <gtest/gtest.h>

#include <cmath>

#include "core/texture_footprint.h"
#include "precompute/precompute.h"
#include "support/scene_builder.h"

namespace relume {
namespace {

/// Two texels side by side, of which sRGB has exact codes: white, black.
constexpr double kTexels[2] = {1.0, 0.0};

/// A floor, and above it a screen of 2 m x 1 m that shows white on one half and black on the other, 100
/// cd/m2. The image goes along x, from 1 to 0 of u.
Scene floor_and_screen() {
  test::SceneBuilder b;
  const auto paint = b.material("paint", Rgb(0.5));
  const auto screen = b.material("screen", Rgb(0.0), Rgb(100.0));
  b.add_quad("floor", paint, {{{0, 0, 0}, {0, 0, 1}, {2, 0, 1}, {2, 0, 0}}});
  b.add_quad("screen", screen, {{{0, 1, 0}, {2, 1, 0}, {2, 1, 1}, {0, 1, 1}}});
  Scene& scene = b.scene();
  scene.images.push_back({2, 1, {255, 255, 255, 255, 0, 0, 0, 255}});
  scene.materials[screen].emission_texture = TextureUse{0, 0};
  scene.surfaces[1].has_uv0 = true;
  for (std::size_t v = 0; v < scene.vertices.uv0.size(); ++v) {
    const glm::dvec3& at = scene.vertices.positions[v];
    scene.vertices.uv0[v] = glm::vec2(1.0 - at.x / 2.0, at.z);
  }
  return scene;
}

TEST(Screen, TheFootprintOfTheModelGivesTheStoredExitance) {
  PrecomputeOptions options;
  options.texel_size = 0.125;
  options.cluster_size = 0.5;
  options.quality = 64;
  PrecomputeReport report;
  const auto model = precompute(floor_and_screen(), options, report);
  ASSERT_TRUE(model) << model.error().message;
  std::size_t shown = 0;
  for (std::uint32_t s = 0; s < model->systems.size(); ++s) {
    const TextureFootprint footprint = texture_footprint(*model, s, 1, 2, 1);
    for (const ClusterFootprint& of : footprint.clusters) {
      double mean = 0.0;
      for (std::uint32_t i = 0; i < of.sample_count; ++i) {
        const FootprintSample& sample = footprint.samples[of.first_sample + i];
        mean += sample.weight * kTexels[sample.u < 0.5f ? 0 : 1];
      }
      const Cluster& cluster = model->systems[s].clusters[of.cluster];
      const Rgb expected(cluster.exitance[0], cluster.exitance[1], cluster.exitance[2]);
      EXPECT_NEAR(exitance_from_radiance(Rgb(100.0 * mean)).x, expected.x, 1e-3);
      // By hand: white is where u < 1/2, so at x above 1; a cluster that ends before it is black.
      const double x = cluster.centroid.x + model->origin.x;
      EXPECT_TRUE(x < 1.3 || std::abs(mean - 1.0) < 1e-5) << x;
      EXPECT_TRUE(x > 0.7 || mean < 1e-5) << x;
      ++shown;
    }
  }
  EXPECT_GE(shown, 8u);  // 2 m2 in clusters of at most 0.5 m
}

}  // namespace
}  // namespace relume
