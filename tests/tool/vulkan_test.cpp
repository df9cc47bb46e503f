// SPDX-License-Identifier: MIT
//
// The program with a Vulkan device, and without one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tool/program.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

/// Two rooms, coarse; the path of the .relume file.
std::string precomputed_rooms(const std::filesystem::path& folder, const std::string& codec = "f32") {
  const std::string file = folder / "rooms.relume";
  write_text(folder / "sensors.csv", "id,px,py,pz,nx,ny,nz\na,1.8,0,1.8,0,1,0\nb,5,0,1.8,0,1,0\n");
  const Finished finished = run_relume({"precompute", make_scene("two_rooms", folder), "-o", file,
                                        "--quality", "64", "--texel-size", "0.25", "--cluster-size", "0.5",
                                        "--codec", codec, "--sensors", folder / "sensors.csv", "--quiet"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  return file;
}

TEST(Vulkan, CompareAgreesWithTheReferenceToFiveDigits) {
  const std::filesystem::path folder = fresh_folder();
  for (const std::string codec : {"f32", "unorm16"}) {
    const std::string file = precomputed_rooms(folder, codec);
    for (const std::string kernel : {"row_per_thread", "row_per_8_lanes"}) {
      const nlohmann::json json = relume_json({"compare", file, "--kernel", kernel});
      EXPECT_EQ(json.at("passed"), true);
      EXPECT_EQ(json.at("kernel"), kernel);
      EXPECT_NE(json.at("device"), "");
      ASSERT_EQ(json.at("outputs").size(), 3u);  // clusters, lumels, sensors
      for (const auto& output : json.at("outputs")) {
        EXPECT_LE(output.at("max_relative_error").get<double>(), 1e-5) << output.at("name");
        EXPECT_LE(output.at("rms_relative_error").get<double>(),
                  output.at("max_relative_error").get<double>());
        EXPECT_GT(output.at("worst").at("reference").get<double>(), 0.0);
        int counted = 0;
        for (const auto& count : output.at("histogram")) counted += count.get<int>();
        EXPECT_EQ(counted, 3 * output.at("count").get<int>());
      }
    }
  }
}

TEST(Vulkan, CompareFailsWithStatus1WhenTheToleranceIsBelowSinglePrecision) {
  const std::string file = precomputed_rooms(fresh_folder());
  const Finished finished = run_relume({"compare", file, "--tolerance", "1e-12", "--json"});
  EXPECT_EQ(finished.status, 1);
  EXPECT_EQ(nlohmann::json::parse(finished.out).at("passed"), false);
  EXPECT_THAT(run_relume({"compare", file, "--tolerance", "1e-12"}).out, HasSubstr("FAILED"));
}

TEST(Vulkan, SolveGivesTheSensorsOfTheReference) {
  const std::filesystem::path folder = fresh_folder();
  const std::string file = precomputed_rooms(folder);
  const nlohmann::json gpu = relume_json({"solve", file, "-o", folder / "gpu", "--bounces", "20"});
  relume_json({"solve", file, "-o", folder / "cpu", "--bounces", "20", "--device", "reference"});
  EXPECT_NE(gpu.at("device"), "reference");
  EXPECT_EQ(gpu.at("bounces"), 20);
  std::string header;
  const auto a = read_csv(folder / "gpu" / "sensors.csv", header);
  const auto b = read_csv(folder / "cpu" / "sensors.csv", header);
  ASSERT_EQ(a.size(), 2u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double reference = std::stod(b[i].at("indirect_g"));
    EXPECT_GT(reference, 0.0);
    EXPECT_NEAR(std::stod(a[i].at("indirect_g")), reference, 1e-5 * reference);
  }
}

TEST(Vulkan, WithoutADeviceSolveEndsWithStatus4AndWritesNothing) {
  const std::filesystem::path folder = fresh_folder();
  const std::string file = precomputed_rooms(folder);
  const std::vector<std::string> no_driver{"VK_ICD_FILENAMES=/nowhere/icd.json",
                                           "VK_DRIVER_FILES=/nowhere/icd.json"};
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"solve", file, "-o", folder / "result"}, {"compare", file}}) {
    const Finished finished = run_relume(arguments, no_driver);
    EXPECT_EQ(finished.status, 4) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "result"));
  EXPECT_EQ(run_relume({"solve", file, "-o", folder / "result", "--device", "reference"}, no_driver).status,
            0);
  const Finished unknown =
      run_relume({"solve", file, "-o", folder / "other", "--device", "vulkan:no such thing"});
  EXPECT_EQ(unknown.status, 4);
  EXPECT_THAT(unknown.err, HasSubstr("no such thing"));
}

}  // namespace
}  // namespace relume::test
