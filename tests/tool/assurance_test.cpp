// SPDX-License-Identifier: MIT
//
// What `solve` says of its own answer: errors by cause, bounds, and the certificate against full rows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tool/program.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kSizes{"--texel-size", "0.1", "--cluster-size", "0.25"};

std::string precompute_into(const std::filesystem::path& file, const std::string& scene,
                            const std::vector<std::string>& options) {
  std::vector<std::string> command{"precompute", scene, "-o", file.string()};
  command.insert(command.end(), kSizes.begin(), kSizes.end());
  command.insert(command.end(), options.begin(), options.end());
  relume_json(command);
  return file.string();
}

TEST(Assurance, NamesEachErrorAndHoldsTheAnswerAgainstFullRows) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder);
  const std::string cut = precompute_into(folder / "cut.relume", scene, {"--error", "10%"});
  const std::string full = precompute_into(folder / "full.relume", scene,
                                           {"--error", "10%", "--budget", "65535", "--values", "f32"});
  const auto stored = relume_json({"info", cut}).at("errors");
  EXPECT_GT(stored.at("clusters").get<double>(), 0.0);
  EXPECT_EQ(stored.at("precision"), 0.006);  // sqrt8
  EXPECT_EQ(stored.at("bounds_bytes"), 0);
  const std::string lamp = (folder / "lamp.json").string();
  write_text(lamp, R"({"lights":[{"type":"point","intensity":100,"position":[0.5,0.7,0.4]}]})");

  const auto solved = relume_json({"solve", cut, "-o", (folder / "out").string(), "--lights", lamp,
                                   "--bounds", "--certify", full, "--device", "reference"});
  const auto& errors = solved.at("errors");
  for (const char* cause : {"clusters", "rays", "cut", "precision", "light", "iteration"}) {
    EXPECT_GE(errors.at(cause).get<double>(), 0.0) << cause;
    EXPECT_LT(errors.at(cause).get<double>(), 0.1) << cause;
  }
  EXPECT_GT(errors.at("light").get<double>(), 0.0);
  // The certificate lies inside of what the bracket allows.
  const double certified = solved.at("certificate").at("relative");
  EXPECT_GT(certified, 0.0);
  EXPECT_LT(certified, solved.at("bounds").at("width_of_95_percent").get<double>());

  const auto against_itself = relume_json({"solve", full, "-o", (folder / "out").string(), "--lights", lamp,
                                           "--certify", full, "--device", "reference"});
  EXPECT_LT(against_itself.at("certificate").at("worst").get<double>(), 1e-4);
}

TEST(Assurance, AnswersOfOtherSurfacesAreNotCompared) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder);
  const std::string one = precompute_into(folder / "one.relume", scene, {});
  const std::string other = (folder / "other.relume").string();
  relume_json({"precompute", scene, "-o", other, "--texel-size", "0.1", "--cluster-size", "0.5"});
  const auto finished = run_relume({"solve", one, "-o", (folder / "out").string(), "--certify", other});
  EXPECT_EQ(finished.status, 3);
  EXPECT_THAT(finished.err, HasSubstr("other.relume: the files have other surfaces"));
  EXPECT_THAT(finished.err, HasSubstr("expected the same scene, texel size and cluster size"));
}

}  // namespace
}  // namespace relume::test
