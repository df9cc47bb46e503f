// SPDX-License-Identifier: MIT
#include "core/include_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace relume {
namespace {

namespace fs = std::filesystem;

TEST(IncludeRules, NobodyCrossesABorder) {
  ASSERT_TRUE(fs::exists(fs::path(RELUME_SOURCE_DIR) / "src/core/model.h"));
  EXPECT_THAT(test::find_crossings(RELUME_SOURCE_DIR), testing::IsEmpty());
}

/// A tree of sources that goes away with the test.
class PlantedTree : public testing::Test {
 protected:
  PlantedTree()
      : root_(fs::path(testing::TempDir()) / ("relume_include_rules_" + std::to_string(::getpid()))) {
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  ~PlantedTree() override { fs::remove_all(root_); }

  /// What the checker says about one file with one line.
  std::vector<std::string> verdict(const std::string& path, const std::string& line) {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << "\n" << line << "\n";
    std::vector<std::string> crossings = test::find_crossings(root_);
    fs::remove(root_ / path);
    return crossings;
  }

  fs::path root_;
};

TEST_F(PlantedTree, CrossingsAreCaught) {
  const std::vector<std::pair<const char*, const char*>> planted{
      {"src/core/model.cpp", "#include \"scene/scene.h\""},
      {"src/core/model.cpp", "#include \"precompute/precompute.h\""},
      {"src/core/model.h", "#  include <vulkan/vulkan.h>"},
      {"src/core/model.cpp", "#include <embree3/rtcore.h>"},
      {"src/core/model.cpp", "#include <tiny_gltf.h>"},
      {"src/core/model.cpp", "#include <nlohmann/json.hpp>"},
      {"src/core/deep/model.cpp", "#include \"compute/solver.h\""},
      {"src/core/model.cpp", "#include \"../scene/scene.h\""},
      {"src/scene/load_scene.cpp", "#include \"precompute/precompute.h\""},
      {"src/scene/load_scene.cpp", "#include <vulkan/vulkan_core.h>"},
      {"src/tool/main.cpp", "#include <embree3/rtcore.h>"},
      {"precompute/rows.cpp", "#include <embree3/rtcore.h>"},
      {"precompute/rows.cpp", "#include \"compute/solver.h\""},
      {"precompute/ray_caster.cpp", "#include <vulkan/vulkan.h>"},
      {"compute/solver.cpp", "#include \"precompute/precompute.h\""},
      {"compute/solver.cpp", "#include \"scene/scene.h\""},
      {"compute/solver.cpp", "#include <nlohmann/json.hpp>"},
      {"compute/standalone/device.cpp", "#include \"scene/scene.h\""},
      {"compute/solver.cpp", "  functions.vkQueueSubmit(queue, 1, &info, fence);"},
      {"compute/solver.cpp", "vkCreateDevice(physical, &info, nullptr, &device);"},
      {"compute/solver.cpp", "  if (vkWaitForFences(device, 1, &fence, VK_TRUE, 0)) return;"},
      {"kernels/shared/limits.h", "#include \"core/model.h\""},
  };
  for (const auto& [path, line] : planted) {
    const std::vector<std::string> crossings = verdict(path, line);
    ASSERT_EQ(crossings.size(), 1u) << path << ": " << line;
    EXPECT_THAT(crossings[0], testing::StartsWith(std::string(path) + ":2: "));
  }
}

TEST_F(PlantedTree, WhatIsAllowedPasses) {
  const std::vector<std::pair<const char*, const char*>> allowed{
      {"src/core/model.cpp", "#include \"core/model.h\""},
      {"src/core/model.cpp", "// as compute/solver.h does with <vulkan/vulkan.h>"},
      {"src/scene/load_scene.cpp", "#include <tiny_gltf.h>"},
      {"src/tool/main.cpp", "#include \"precompute/precompute.h\""},
      {"src/tool/main.cpp", "#include <nlohmann/json.hpp>"},
      {"precompute/ray_caster.cpp", "#include <embree3/rtcore.h>"},
      {"precompute/embree_compat.h", "#include <embree4/rtcore.h>"},
      {"precompute/rows.cpp", "#include \"scene/scene.h\""},
      {"compute/solver.cpp", "#include <vulkan/vulkan.h>"},
      {"compute/solver.cpp", "// the host calls vkQueueSubmit"},
      {"compute/solver.cpp", "vkCreateDescriptorPool(device, &info, nullptr, &pool);"},
      {"compute/standalone/device.cpp", "vkQueueSubmit(queue, 1, &info, fence);"},
      {"notes.cpp", "#include <embree3/rtcore.h>"},
  };
  for (const auto& [path, line] : allowed) {
    EXPECT_THAT(verdict(path, line), testing::IsEmpty()) << path << ": " << line;
  }
}

}  // namespace
}  // namespace relume
