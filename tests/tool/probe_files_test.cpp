// SPDX-License-Identifier: MIT
//
// Light probes from a CSV to probes.csv.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
