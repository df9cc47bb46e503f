// SPDX-License-Identifier: MIT
//
// What --dry-run says beforehand against what the precompute then does, and --max-memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tool/program.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

class DryRun : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(DryRun, ForetellsRowsFormFactorsAndBytes) {
  const std::filesystem::path folder = fresh_folder();
  std::vector<std::string> arguments{"precompute", make_scene("two_rooms", folder)};
  arguments.insert(arguments.end(), GetParam().begin(), GetParam().end());
  std::vector<std::string> dry = arguments;
  dry.push_back("--dry-run");
  const nlohmann::json estimate = relume_json(dry);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);  // the scene alone

  arguments.insert(arguments.end(), {"-o", (folder / "a.relume").string()});
  const nlohmann::json done = relume_json(arguments);
  const auto both = [&](const char* key) {
    return done.at("bounce").at(key).get<double>() + done.at("gather").at(key).get<double>();
  };
  EXPECT_EQ(estimate.at("rows"), both("rows") + done.at("probes").get<double>());
  const auto near = [](double expected, double found) {
    EXPECT_LT(expected, 1.5 * found);
    EXPECT_GT(expected, found / 1.5);
  };
  near(estimate.at("nonzeros"), both("nonzeros") + done.at("probe_entries").get<double>());
  near(estimate.at("bytes"), done.at("file_bytes"));
  near(estimate.at("rays"), done.at("rays").get<double>() + done.at("occlusion_rays").get<double>());
  EXPECT_GT(estimate.at("seconds").get<double>(), 0.0);
  EXPECT_GT(estimate.at("memory").get<double>(), 1e6);
  EXPECT_GT(done.at("peak_memory").get<double>(), 1e6);
}

const std::vector<std::string> kSizes{"--texel-size", "0.15", "--cluster-size", "0.3"};
std::vector<std::string> with_sizes(std::vector<std::string> options) {
  options.insert(options.end(), kSizes.begin(), kSizes.end());
  return options;
}

INSTANTIATE_TEST_SUITE_P(Options, DryRun,
                         testing::Values(with_sizes({"--quality", "64"}),
                                         with_sizes({"--quality", "64", "--budget", "48", "--values",
                                                     "sqrt8"}),
                                         with_sizes({"--quality", "64", "--system-lumels", "1000"}),
                                         with_sizes({"--quality", "64", "--probes", "0.4"}),
                                         with_sizes({"--error", "10%", "--probes", "auto"})));

TEST(MaxMemory, IsRefusedBeforehandWithTheNumberNeeded) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder), file = (folder / "a.relume").string();
  const Finished refused = run_relume({"precompute", scene, "-o", file, "--max-memory", "5M"});
  EXPECT_EQ(refused.status, 5);
  EXPECT_THAT(refused.err, HasSubstr("memory: expected at most 5 MB (--max-memory), found a need of about "));
  EXPECT_THAT(refused.err, HasSubstr("--budget"));
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(MaxMemory, ThatIsEnoughChangesNoByte) {
  const Precomputed free = precomputed("furnace_box", kCoarse);
  std::vector<std::string> options = kCoarse;
  options.insert(options.end(), {"--max-memory", "16G"});
  EXPECT_EQ(read_text(free.file), read_text(precomputed("furnace_box", options).file));
}

}  // namespace
}  // namespace relume::test
