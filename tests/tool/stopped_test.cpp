// SPDX-License-Identifier: MIT
//
// What a precompute leaves behind that is stopped from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <iostream>
#include <iterator>
#include <random>

#include "support/repeats.h"
#include "tool/program.h"

namespace relume::test {
namespace {

TEST(Stopped, CtrlCLeavesNothing) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("demo", folder);
  const std::string file = folder / "demo.relume";
  // Minutes of work: it is still busy when the signal comes.
  const Finished stopped = run_relume({"precompute", scene, "-o", file, "--quality", "16384", "--json"}, {},
                                      {SIGINT, std::chrono::seconds(1)});
  EXPECT_EQ(stopped.status, 130) << stopped.err;
  EXPECT_EQ(nlohmann::json::parse(stopped.out).at("exit"), 130);
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    left.push_back(entry.path().filename());
  EXPECT_THAT(left, testing::ElementsAre("demo.glb"));
}

// Killed at a random moment of a precompute that replaces a file, the writing of it included: there is the
// old file or the new one, and after Ctrl-C nothing else.
TEST(Stopped, AtAnyMomentLeavesTheOldFileOrTheNewOne) {
  const Precomputed box = precomputed("furnace_box", kCoarse);
  const auto precompute = [&](const std::string& file, const Interruption& interruption) {
    std::vector<std::string> command{"precompute", box.scene, "-o", file,     "--quality",
                                     "64",         "--seed",  "1",  "--quiet"};
    command.insert(command.end(), kCoarse.begin(), kCoarse.end());
    return run_relume(command, {}, interruption).status;
  };
  const std::string before = read_text(box.file);
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(precompute(box.folder / "other.relume", {}), 0);
  const std::chrono::duration<double, std::micro> whole = std::chrono::steady_clock::now() - start;
  const std::string after = read_text(box.folder / "other.relume");
  ASSERT_NE(before, after);
  std::minstd_rand random(1);
  // Early ones more often, so that some come before the end whatever else the machine does.
  const auto moment = [&] {
    const double share = std::uniform_real_distribution<double>(0.0, 1.0)(random);
    return std::chrono::microseconds(std::lround(1.2 * whole.count() * share * share));
  };
  const int points = repeats("RELUME_KILL_POINTS", 10);
  int killed = 0, replaced = 0;
  for (int i = 0; i < points; ++i) {
    const std::filesystem::path folder = fresh_folder();
    write_text(folder / "box.relume", before);
    const int signal = i % 2 == 0 ? SIGINT : SIGKILL;
    const int status = precompute(folder / "box.relume", {signal, moment()});
    ASSERT_TRUE(status == 0 || status == 128 + signal) << status;
    const std::string left = read_text(folder / "box.relume");
    ASSERT_TRUE(left == before || left == after) << left.size() << " bytes";
    ASSERT_TRUE(status != 0 || left == after);
    const auto files = std::distance(std::filesystem::directory_iterator(folder), {});
    ASSERT_TRUE(signal == SIGKILL || files == 1) << files << " files after Ctrl-C";
    if (status != 0) ++killed;
    if (left == after) ++replaced;
  }
  EXPECT_GT(killed, 0);
  std::cout << points << " kill points: " << killed << " processes killed, " << replaced << " files new\n";
}

}  // namespace
}  // namespace relume::test
