// SPDX-License-Identifier: MIT
#include "compute/screen_pass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <cmath>

#include "compute/host_image.h"
#include "compute/pass_fixture.h"
#include "compute/test_models.h"
#include "scene/surface_color.h"
#include "support/quad_model.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

struct Codes {
  std::uint32_t width, height;
  std::vector<std::uint8_t> rgba;  ///< sRGB
};

/// IEC 61966-2-1.
float linear(std::uint8_t code) {
  const double v = code / 255.0;
  return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

std::vector<float> linear(const Codes& image) {
  std::vector<float> values;
  for (const std::uint8_t code : image.rgba) values.push_back(linear(code));
  return values;
}

Codes noise(std::uint32_t width, std::uint32_t height) {
  Random random(3);
  Codes image{width, height, {}};
  for (std::uint32_t i = 0; i < 4 * width * height; ++i)
    image.rgba.push_back(static_cast<std::uint8_t>(random.below(256)));
  return image;
}

/// `columns` clusters side by side that show one image together, s along x and t along y.
Model video_wall(std::uint32_t columns, std::uint32_t cells) {
  Model model;
  for (std::uint32_t i = 0; i < columns; ++i) {
    add_quad(model, {{i, 0, 0}, {1, 0, 0}, {0, 1, 0}}, cells);
    const float left = float(i) / float(columns), right = float(i + 1) / float(columns);
    model.occluders.texture.push_back(
        {2 * i, {glm::vec2{left, 0}, glm::vec2{right, 0}, glm::vec2{right, 1}}});
    model.occluders.texture.push_back(
        {2 * i + 1, {glm::vec2{left, 0}, glm::vec2{right, 1}, glm::vec2{left, 1}}});
  }
  return model;
}

/// The same as a scene whose material emits the image.
Scene scene_of(const Model& model, const Codes& image) {
  Scene scene;
  scene.images = {{image.width, image.height, image.rgba}};
  scene.materials.resize(1);
  scene.materials[0].emission = Rgb(100.0, 50.0, 25.0);
  scene.materials[0].emission_texture = TextureUse{0, 0};
  for (const TextureTriangle& listed : model.occluders.texture) {
    const auto first = static_cast<std::uint32_t>(scene.vertices.uv0.size());
    scene.vertices.uv0.insert(scene.vertices.uv0.end(), listed.corners.begin(), listed.corners.end());
    scene.triangles.push_back({first, first + 1, first + 2});
  }
  scene.vertices.positions.resize(scene.vertices.uv0.size());
  scene.vertices.uv1.resize(scene.vertices.uv0.size());
  const auto triangles = static_cast<std::uint32_t>(scene.triangles.size());
  scene.surfaces = {{0, 0, 0, triangles, true, false, false}};
  return scene;
}

class ScreenPassTest : public PassTest {
 protected:
  /// Albedo, or exitance, of the clusters after the image was shown in place of -1.
  template <class Texel>
  std::vector<Rgb> shown(const Model& model, VkExtent2D size, const std::vector<Texel>& texels,
                         VkFormat format, const ScreenPassOptions& options, const Rgb& factor) {
    const TextureFootprint footprint = texture_footprint(model, 0, 0, size.width, size.height);
    auto pass = ScreenPass::create(device().host(), model.systems[0], footprint, options);
    EXPECT_TRUE(pass) << pass.error().message;
    if (!pass) return {};
    const VkDeviceSize bytes = 16 * model.systems[0].clusters.size();
    const ClusterColorRanges colors{allocate("albedo", bytes), allocate("exitance", bytes)};
    const std::vector<BufferRange> ranges = allocate(pass->buffers());
    EXPECT_TRUE(pass->bind(ranges, colors));
    upload(ranges, screen_data(footprint));
    upload(colors.albedo, std::vector<float>(bytes / 4, -1.0f));
    upload(colors.exitance, std::vector<float>(bytes / 4, -1.0f));

    HostImage image(device(), {format, size, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    image.upload(device(), std::as_bytes(std::span(texels)), kImageSampled);
    const VulkanHandle<VkSampler> sampler = nearest_sampler(device());
    const auto number = pass->add_image({image.view(format, VK_IMAGE_USAGE_SAMPLED_BIT), sampler.get()});
    EXPECT_TRUE(number) << number.error().message;
    EXPECT_TRUE(device().submit([&](VkCommandBuffer commands) { pass->record(commands, *number, factor); }));
    const bool albedo = options.target == ScreenTarget::albedo;
    for (const Rgb& other : read_rgb(albedo ? colors.exitance : colors.albedo)) EXPECT_EQ(other, Rgb(-1.0));
    return read_rgb(albedo ? colors.albedo : colors.exitance);
  }
};

// White and black fields, 8 x 8: half of 100 cd/m2 is 50 cd/m2, which is 50 pi lm/m2. 16 cells of 2 x 256
// points each err by less than 4 / 256.
TEST_F(ScreenPassTest, ACheckerboardIsHalfAsBright) {
  std::vector<float> board;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float value = (x / 8 + y / 8) % 2 == 0 ? 1.0f : 0.0f;
      board.insert(board.end(), {value, value, value, 1.0f});
    }
  }
  const auto exitance =
      shown(video_wall(1, 4), {64, 64}, board, VK_FORMAT_R32G32B32A32_SFLOAT, {}, Rgb(100.0, 10.0, 0.0));
  EXPECT_NEAR(exitance[0].x, 157.07963, 157.07963 * 4.0 / 256.0);
  EXPECT_NEAR(exitance[0].y, 15.707963, 15.707963 * 4.0 / 256.0);
  EXPECT_EQ(exitance[0].z, 0.0);
}

// Two texels, two clusters: each shows its own, and nothing of the other.
TEST_F(ScreenPassTest, EachClusterShowsItsPartOfTheImage) {
  const std::vector<float> red_blue{1.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.5f, 1.0f};
  const auto albedo = shown(video_wall(2, 2), {2, 1}, red_blue, VK_FORMAT_R32G32B32A32_SFLOAT,
                            {.target = ScreenTarget::albedo, .max_albedo = 0.75}, Rgb(1.0));
  ASSERT_EQ(albedo.size(), 2u);
  EXPECT_NEAR(albedo[0].x, 0.75, 1e-6);  // clamped
  EXPECT_EQ(albedo[0].z, 0.0);
  EXPECT_EQ(albedo[1].x, 0.0);
  EXPECT_NEAR(albedo[1].z, 0.5, 1e-6);
}

TEST_F(ScreenPassTest, GivesTheMeansOfTheProcessor) {
  const Model model = video_wall(5, 3);
  const Codes image = noise(40, 24);
  const ClusterColors expected = cluster_colors(model, scene_of(model, image), 0.95);
  const auto exitance =
      shown(model, {40, 24}, linear(image), VK_FORMAT_R32G32B32A32_SFLOAT, {}, Rgb(100.0, 50.0, 25.0));
  ASSERT_EQ(exitance.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(exitance[i][c], expected.exitance[i][c], 1e-5 * expected.exitance[i][c]);
  }
}

// The device decodes sRGB as it likes, within half a code of 8 bits.
TEST_F(ScreenPassTest, AnImageOfCodesIsDecodedByItsFormat) {
  const Model model = video_wall(3, 2);
  const Codes image = noise(30, 10);
  const ClusterColors expected = cluster_colors(model, scene_of(model, image), 0.95);
  const auto exitance =
      shown(model, {30, 10}, image.rgba, VK_FORMAT_R8G8B8A8_SRGB, {}, Rgb(100.0, 50.0, 25.0));
  ASSERT_EQ(exitance.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(exitance[i].x, expected.exitance[i].x, 0.01 * expected.exitance[i].x);
}

TEST_F(ScreenPassTest, RefusesWhatNobodyShows) {
  const Model model = video_wall(1, 1);
  const auto none = ScreenPass::create(device().host(), model.systems[0], {}, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::usage);
  EXPECT_THAT(none.error().message, HasSubstr("0 clusters that show the image"));
}

}  // namespace
}  // namespace relume::test
