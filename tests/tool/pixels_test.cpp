// SPDX-License-Identifier: MIT
//
// Pictures and lightmaps of a furnace, whose every pixel is known: albedo 0.5 and radiance 1 make B = 2 pi,
// so that 2 pi lux arrive everywhere and every ray of a camera inside meets radiance 2.
#include <gtest/gtest.h>
#include <stb_image.h>
#include <tinyexr.h>

#include <memory>

#include "scene/load_scene.h"
#include "tool/free_memory.h"
#include "tool/program.h"

namespace relume::test {
namespace {

/// Exposure puts the mean, 2, at 0.3, which is below white: the curve gives 0.3 (1 + 0.3) / (1 + 0.3), and
/// sRGB codes 0.3 as 148.6. Rows of 64 rays sum to 1 within 0.1 %, a seventh of a level.
constexpr int kFurnaceLevel = 149;

/// A solved furnace; the folder of the results.
std::filesystem::path solved_furnace() {
  const Precomputed box = precomputed("furnace_box", kCoarse);
  solve_json(box, {"--tolerance", "1e-6"});
  return box.folder / "result";
}

TEST(Pixels, PreviewOfAFurnaceIsOneColour) {
  const std::string file = solved_furnace() / "preview.png";
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, FreeMemory> pixels(stbi_load(file.c_str(), &width, &height, &channels, 3));
  ASSERT_TRUE(pixels);
  EXPECT_EQ(width, 960);
  EXPECT_EQ(height, 540);
  int off = 0;
  for (int i = 0; i < 3 * width * height; ++i) off += std::abs(pixels.get()[i] - kFurnaceLevel) > 1;
  EXPECT_EQ(off, 0);
}

TEST(Pixels, ResultGlbOfAFurnaceIsOneColour) {
  const Result<Scene> scene = load_scene(solved_furnace() / "result.glb");
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->images.size(), 1u);
  const SceneImage& image = scene->images[0];
  int shown = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    if (image.rgba[i] == 0) continue;  // between charts
    EXPECT_NEAR(image.rgba[i], kFurnaceLevel, 1);
    ++shown;
  }
  EXPECT_GE(shown, 600);  // 6 m2 in lumels of at most 0.1 m
  // Every corner of every triangle lies on a texel that shows something.
  for (const auto& triangle : scene->triangles) {
    for (const std::uint32_t corner : triangle) {
      const glm::vec2 uv = scene->vertices.uv1[corner];
      const auto x = std::min(static_cast<std::uint32_t>(uv.x * float(image.width)), image.width - 1);
      const auto y = std::min(static_cast<std::uint32_t>(uv.y * float(image.height)), image.height - 1);
      EXPECT_NE(image.rgba[4 * (std::size_t{y} * image.width + x)], 0);
    }
  }
}

TEST(Pixels, LightmapsOfAFurnaceHoldLux) {
  const std::filesystem::path folder = solved_furnace() / "lightmaps";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    float* memory = nullptr;
    int width = 0, height = 0;
    const char* message = nullptr;
    ASSERT_EQ(LoadEXR(&memory, &width, &height, entry.path().c_str(), &message), TINYEXR_SUCCESS);
    const std::unique_ptr<float, FreeMemory> pixels(memory);
    const bool indirect = entry.path().string().find(".indirect.") != std::string::npos;
    int lit = 0;
    for (int i = 0; i < 4 * width * height; i += 4) {
      if (memory[i] == 0.0f) continue;
      EXPECT_NEAR(memory[i], 2.0f * 3.14159265f, 0.01f);  // 0.1 % of noise, and half precision
      ++lit;
    }
    EXPECT_EQ(lit > 600, indirect);  // nothing is lit directly
    EXPECT_EQ(lit == 0, !indirect);
    ++files;
  }
  EXPECT_EQ(files, 2);
}

}  // namespace
}  // namespace relume::test
