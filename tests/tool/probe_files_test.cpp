// SPDX-License-Identifier: MIT
//
// Light probes from a CSV to probes.csv and probes.exr.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyexr.h>

#include <cstdlib>

#include "tool/program.h"

namespace relume::test {
namespace {

double number(const std::map<std::string, std::string>& row, const std::string& column) {
  return std::stod(row.at(column));
}

// In a furnace light comes alike from all sides.
TEST(ProbeFiles, ProbesInAFurnace) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder), file = (folder / "a.relume").string();
  write_text(folder / "probes.csv", "id,px,py,pz\nmiddle,0.5,0.5,0.5\nfar away,90,0,0\n");
  std::vector<std::string> command{"precompute", scene, "-o", file, "--probes", folder / "probes.csv"};
  command.insert(command.end(), kCoarse.begin(), kCoarse.end());
  EXPECT_EQ(relume_json(command).at("probes"), 2);
  relume_json({"solve", file, "-o", folder / "result"});
  std::string header;
  const auto rows = read_csv(folder / "result" / "probes.csv", header);
  EXPECT_EQ(
      header,
      "id,px,py,pz,valid,c0_r,c0_g,c0_b,c1_r,c1_g,c1_b,c2_r,c2_g,c2_b,c3_r,c3_g,c3_b,c4_r,c4_g,c4_b,c5_r,"
      "c5_g,c5_b,c6_r,c6_g,c6_b,c7_r,c7_g,c7_b,c8_r,c8_g,c8_b");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("id"), "middle");
  EXPECT_EQ(rows[0].at("valid"), "1");
  EXPECT_EQ(number(rows[1], "px"), 90.0);
  EXPECT_GT(number(rows[0], "c0_g"), 0.0);
  EXPECT_NEAR(number(rows[0], "c1_g"), 0.0, 0.01 * number(rows[0], "c0_g"));

  // The picture: a row of nine texels for each.
  float* memory = nullptr;
  int width = 0, height = 0;
  const std::string exr = folder / "result" / "probes.exr";
  ASSERT_EQ(LoadEXR(&memory, &width, &height, exr.c_str(), nullptr), TINYEXR_SUCCESS);
  const std::vector<float> texels(memory, memory + 4 * std::ptrdiff_t{width} * height);
  std::free(memory);
  ASSERT_EQ(width, 9);
  ASSERT_EQ(height, 2);
  for (std::size_t p = 0; p < 2; ++p) {
    for (std::size_t h = 0; h < 9; ++h) {
      const float* texel = &texels[4 * (9 * p + h)];
      for (std::size_t c = 0; c < 3; ++c) {
        const std::string column = "c" + std::to_string(h) + "_" + "rgb"[c];
        EXPECT_FLOAT_EQ(texel[c], float(number(rows[p], column))) << column;
      }
      EXPECT_EQ(texel[3], rows[p].at("valid") == "1" ? 1.0f : 0.0f);
    }
  }
}

TEST(ProbeFiles, ABrokenLineOfProbesIsOneErrorAndStatus3) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder);
  for (const std::string text : {"id,px,py,pz\na,1,2,3\nb,1,2\n", "a,1,2,3\n", ""}) {
    write_text(folder / "probes.csv", text);
    const Finished refused = run_relume(
        {"precompute", scene, "-o", (folder / "a.relume").string(), "--probes", folder / "probes.csv"});
    EXPECT_EQ(refused.status, 3);
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "a.relume"));
}

}  // namespace
}  // namespace relume::test
