// SPDX-License-Identifier: MIT
//
// The program with a Vulkan device, and without one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model_file.h"
#include "tool/direct_light.h"
#include "tool/program.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

/// Two rooms, coarse; the path of the .relume file.
std::string precomputed_rooms(const std::filesystem::path& folder, const std::string& codec = "f32") {
  const std::string file = folder / "rooms.relume";
  write_text(folder / "sensors.csv", "id,px,py,pz,nx,ny,nz\na,1.8,0,1.8,0,1,0\nb,5,0,1.8,0,1,0\n");
  write_text(folder / "probes.csv", "id,px,py,pz\np,1.8,1.2,1.8\nq,5,0.6,1\n");
  const Finished finished =
      run_relume({"precompute", make_scene("two_rooms", folder), "-o", file, "--probes",
                  folder / "probes.csv", "--quality", "64", "--texel-size", "0.25", "--cluster-size", "0.5",
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
      ASSERT_EQ(json.at("outputs").size(), 4u);  // clusters, lumels, sensors, probes
      for (const auto& output : json.at("outputs")) {
        EXPECT_LE(output.at("max_relative_error").get<double>(), 1e-5) << output.at("name");
        EXPECT_LE(output.at("rms_relative_error").get<double>(),
                  output.at("max_relative_error").get<double>());
        EXPECT_NE(output.at("worst").at("reference").get<double>(), 0.0);
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
  const nlohmann::json cpu =
      relume_json({"solve", file, "-o", folder / "cpu", "--bounces", "20", "--device", "reference"});
  EXPECT_EQ(cpu.at("direct_light"), "processor");
  EXPECT_NE(gpu.at("device"), "reference");
  EXPECT_EQ(gpu.at("direct_light"), gpu.at("device"));
  EXPECT_EQ(gpu.at("bounces"), 20);
  std::string header;
  const auto a = read_csv(folder / "gpu" / "sensors.csv", header);
  const auto b = read_csv(folder / "cpu" / "sensors.csv", header);
  ASSERT_EQ(a.size(), 2u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (const char* column : {"direct_g", "indirect_g"}) {
      // Shadow rays within rounding of an edge may go either way.
      const double reference = std::stod(b[i].at(column));
      EXPECT_NEAR(std::stod(a[i].at(column)), reference, 1e-4 * reference) << column;
    }
    EXPECT_GT(std::stod(a[i].at("indirect_g")), 0.0);
  }
  const auto probes = read_csv(folder / "gpu" / "probes.csv", header);
  const auto expected = read_csv(folder / "cpu" / "probes.csv", header);
  ASSERT_EQ(probes.size(), 2u);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const double whole = std::stod(expected[i].at("c0_g"));
    EXPECT_GT(whole, 0.0);
    for (const char* column : {"c0_g", "c1_g", "c3_g", "c8_g"})
      EXPECT_NEAR(std::stod(probes[i].at(column)), std::stod(expected[i].at(column)), 1e-5 * whole) << column;
  }
}

/// Numbers of a device have 24 bits.
bool single_precision(const std::vector<Rgb>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](const Rgb& value) { return Rgb(glm::vec3(value)) == value; });
}

TEST(Vulkan, TheDeviceThatSolvesComputesDirectLight) {
  const Result<Model> model = read_model(precomputed_rooms(fresh_folder()));
  ASSERT_TRUE(model);
  Console console({.quiet = true});
  std::string by;
  const auto device = set_up_lighting(*model, {}, console, direct_light_of_device("", console, by));
  const auto processor = set_up_lighting(*model, {}, console);
  ASSERT_TRUE(device && processor);
  EXPECT_NE(by, kProcessor);
  for (const auto values : {&device->lighting.direct, &device->gather_direct})
    EXPECT_TRUE(single_precision(*values));
  EXPECT_FALSE(single_precision(processor->lighting.direct));
  double off = 0.0, whole = 0.0;
  for (std::size_t i = 0; i < processor->gather_direct.size(); ++i) {
    off += std::abs(device->gather_direct[i].g - processor->gather_direct[i].g);
    whole += processor->gather_direct[i].g;
  }
  EXPECT_GT(whole, 0.0);
  EXPECT_LE(off, 1e-3 * whole);
}

TEST(Vulkan, WithoutRoomForTheOccludersTheProcessorComputesDirectLight) {
  const Result<Model> model = read_model(precomputed_rooms(fresh_folder()));
  ASSERT_TRUE(model);
  const std::vector<Light>& lights = model->lights;
  Console console({.quiet = true});
  std::string by = "a device";
  const auto direct = or_by_processor(fail(ErrorCode::no_device, "the buffer 'occluder tree' needs 1 byte"),
                                      *model, lights, console, by);
  ASSERT_TRUE(direct);
  EXPECT_EQ(direct->clusters, direct_irradiance(*model, lights)->clusters);
  EXPECT_EQ(by, kProcessor);
  ASSERT_EQ(console.warnings().size(), 1u);
  EXPECT_THAT(console.warnings()[0], HasSubstr("the buffer 'occluder tree' needs 1 byte"));

  const auto other = or_by_processor(fail(ErrorCode::check_failed, "it broke"), *model, lights, console, by);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::check_failed);
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
