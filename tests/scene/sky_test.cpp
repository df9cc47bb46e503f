// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/gltf_sketch.h"
#include "scene/load_scene.h"
#include "scene/shared_files.h"

namespace relume {
namespace {

/// A .hdr of 2 x 1 pixels, flat RGBE: value = mantissa / 256 x 2^(exponent - 128).
std::string hdr(const std::string& pixels, const std::string& size = "-Y 1 +X 2") {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n" + pixels;
}

TEST(Sky, PixelsAreRadiance) {
  const test::ScratchFolder folder;
  const std::string pixels = {char(128), char(64), char(32), char(129), char(0), char(0), char(0), char(0)};
  const auto sky = load_sky(folder.write("sky.hdr", hdr(pixels)));
  ASSERT_TRUE(sky.has_value()) << sky.error().message;
  EXPECT_EQ(sky->width, 2u);
  EXPECT_EQ(sky->height, 1u);
  EXPECT_EQ(sky->radiance.at(0), glm::vec3(1.0f, 0.5f, 0.25f));
  EXPECT_EQ(sky->radiance.at(1), glm::vec3(0.0f));
}

TEST(Sky, OtherFilesAndShapesAreRefused) {
  const test::ScratchFolder folder;
  const auto message = [&](const std::string& bytes) {
    const auto sky = load_sky(folder.write("sky.hdr", bytes));
    return sky ? std::string("loaded") : sky.error().message;
  };
  EXPECT_THAT(message("not an image"), testing::HasSubstr("sky.hdr: byte 0: expected a Radiance .hdr image"));
  EXPECT_THAT(message(""), testing::HasSubstr("sky.hdr"));
  EXPECT_THAT(message(hdr(std::string(8, char(128)), "-Y 2 +X 1")),
              testing::HasSubstr("twice as wide as high"));
  EXPECT_EQ(load_sky(folder.path() / "none.hdr").error().code, ErrorCode::bad_input);
  SceneLimits limits;
  limits.max_image_pixels = 1;
  EXPECT_FALSE(load_sky(folder.write("sky.hdr", hdr(std::string(8, char(128)))), limits).has_value());
}

TEST(Sky, TheSharedSkyFollowsItsFormula) {
  const auto shared = test::shared_files();
  if (!shared) GTEST_SKIP() << "the shared files are not beside the repository";
  const auto sky = load_sky(*shared / "truth" / "room_sky.hdr");
  ASSERT_TRUE(sky.has_value()) << sky.error().message;
  EXPECT_EQ(sky->width, 128u);
  EXPECT_EQ(sky->height, 64u);
  // Radiance depends on height only, and grows towards +Y, which is row 0.
  EXPECT_EQ(sky->radiance.at(0), sky->radiance.at(127));
  EXPECT_NE(sky->radiance.at(0), sky->radiance.at(40 * 128));
  EXPECT_EQ(sky->radiance.at(40 * 128), sky->radiance.at(60 * 128)) << "constant below the horizon";
}

}  // namespace
}  // namespace relume
