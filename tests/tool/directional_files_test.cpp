// SPDX-License-Identifier: MIT
//
// From --directional to the pictures of dominant directions.
#include <gtest/gtest.h>
#include <tinyexr.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tool/program.h"

namespace relume::test {
namespace {

// In a furnace each lumel has 2/3 along its normal, which is an axis.
TEST(DirectionalFiles, OfAFurnaceAreTwoThirdsAlongTheAxes) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder), file = (folder / "a.relume").string();
  std::vector<std::string> command{"precompute", scene, "-o", file, "--directional"};
  command.insert(command.end(), kCoarse.begin(), kCoarse.end());
  relume_json(command);
  EXPECT_EQ(run_relume({"check", file}).status, 0);
  for (const std::string device : {"reference", "vulkan"}) {
    const std::filesystem::path result = folder / device;
    relume_json({"solve", file, "-o", result, "--device", device});
    std::size_t found = 0;
    for (const auto& entry : std::filesystem::directory_iterator(result / "lightmaps")) {
      if (entry.path().string().find(".directional.exr") == std::string::npos) continue;
      float* pixels = nullptr;
      int width = 0, height = 0;
      ASSERT_EQ(LoadEXR(&pixels, &width, &height, entry.path().c_str(), nullptr), TINYEXR_SUCCESS);
      for (int i = 0; i < width * height; ++i) {
        const float most =
            std::max({std::abs(pixels[4 * i]), std::abs(pixels[4 * i + 1]), std::abs(pixels[4 * i + 2])});
        if (most == 0.0f) continue;
        EXPECT_NEAR(most, 2.0f / 3.0f, 0.05f);
        ++found;
      }
      std::free(pixels);
    }
    EXPECT_GT(found, 20u);
  }
  const auto compared = relume_json({"compare", file});
  EXPECT_EQ(compared.at("passed"), true);
  EXPECT_NE(compared.dump().find("directions of irradiance"), std::string::npos);
}

}  // namespace
}  // namespace relume::test
