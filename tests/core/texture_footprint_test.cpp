// SPDX-License-Identifier: MIT
#include "core/texture_footprint.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/quad_model.h"

namespace relume::test {
namespace {

/// A piece has 256 points here; N points of a low-discrepancy sequence miss a mean by less than some 4 / N of
/// the range.
constexpr double kPointError = 4.0 / 256.0;

/// A wall of 2 m x 1 m; the image covers it once, s along x and t along y.
Model screen(std::uint32_t cells) {
  Model model;
  add_quad(model, {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}}, cells);
  model.occluders.texture = {{0, {glm::vec2{0, 0}, glm::vec2{1, 0}, glm::vec2{1, 1}}},
                             {1, {glm::vec2{0, 0}, glm::vec2{1, 1}, glm::vec2{0, 1}}}};
  return model;
}

template <class Image>
double mean(const TextureFootprint& footprint, std::size_t cluster, const Image& image) {
  double sum = 0.0;
  const ClusterFootprint& of = footprint.clusters[cluster];
  for (std::uint32_t i = 0; i < of.sample_count; ++i) {
    const FootprintSample& sample = footprint.samples[of.first_sample + i];
    sum += sample.weight * image(sample.u, sample.v);
  }
  return sum;
}

TEST(TextureFootprint, WeightsAddUpToOne) {
  const TextureFootprint footprint = texture_footprint(screen(4), 0, 0, 64, 64);
  ASSERT_EQ(footprint.clusters.size(), 1u);
  EXPECT_NEAR(mean(footprint, 0, [](float, float) { return 1.0; }), 1.0, 1e-6);
}

// Over the whole image: the mean of u is 1/2, of v^2 1/3, of a checkerboard of 8 x 8 fields 1/2.
TEST(TextureFootprint, GivesMeansByArea) {
  const TextureFootprint footprint = texture_footprint(screen(4), 0, 0, 64, 64);
  EXPECT_NEAR(mean(footprint, 0, [](float u, float) { return u; }), 0.5,
              kPointError / 4);  // a piece spans 1/4
  EXPECT_NEAR(mean(footprint, 0, [](float, float v) { return v * v; }), 1.0 / 3.0,
              kPointError / 2);  // and at most 1 - (3/4)^2
  const auto board = [](float u, float v) {
    return (static_cast<int>(u * 8.0f) + static_cast<int>(v * 8.0f)) % 2 == 0 ? 1.0 : 0.0;
  };
  EXPECT_NEAR(mean(footprint, 0, board), 0.5, kPointError);
}

// Left half and right half are clusters of their own: each sees its half of the image alone.
TEST(TextureFootprint, KeepsClustersApart) {
  Model model;
  add_quad(model, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 2);
  add_quad(model, {{1, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 2);
  model.occluders.texture = {{0, {glm::vec2{0, 0}, glm::vec2{0.5, 0}, glm::vec2{0.5, 1}}},
                             {1, {glm::vec2{0, 0}, glm::vec2{0.5, 1}, glm::vec2{0, 1}}},
                             {2, {glm::vec2{0.5, 0}, glm::vec2{1, 0}, glm::vec2{1, 1}}},
                             {3, {glm::vec2{0.5, 0}, glm::vec2{1, 1}, glm::vec2{0.5, 1}}}};
  const TextureFootprint footprint = texture_footprint(model, 0, 0, 16, 16);
  ASSERT_EQ(footprint.clusters.size(), 2u);
  const auto right = [](float u, float) { return u > 0.5f ? 1.0 : 0.0; };
  EXPECT_NEAR(mean(footprint, 0, right), 0.0, 1e-6);
  EXPECT_NEAR(mean(footprint, 1, right), 1.0, 1e-6);
}

// Of the second triangle everything is cut out: the first alone counts, where v < u. The mean of u is 2/3
// there.
TEST(TextureFootprint, WhatAlphaCutsOutDoesNotCount) {
  Model model = screen(1);
  model.occluders.opacity.maps = {{OpacityRule::mask, 0.5f, 1.0f}};
  model.occluders.opacity.triangles = {{1, 0, {}}};
  const TextureFootprint footprint = texture_footprint(model, 0, 0, 64, 64);
  EXPECT_NEAR(mean(footprint, 0, [](float u, float) { return u; }), 2.0 / 3.0, kPointError);
}

TEST(TextureFootprint, LeavesOutOtherMaterialsAndWhatHasNoCoordinates) {
  EXPECT_TRUE(texture_footprint(screen(2), 0, 1, 8, 8).clusters.empty());
  Model bare = screen(2);
  bare.occluders.texture.clear();
  EXPECT_TRUE(texture_footprint(bare, 0, 0, 8, 8).clusters.empty());
}

}  // namespace
}  // namespace relume::test
