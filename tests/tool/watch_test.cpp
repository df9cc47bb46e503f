// SPDX-License-Identifier: MIT
//
// `relume watch` as a process beside the test, which saves scenes as editors do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "support/repeats.h"
#include "tool/program.h"

namespace relume::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A square of `size` m whose corners are in a file of their own.
void write_square(const std::filesystem::path& folder) {
  write_text(folder / "square.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0,"name":"square"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":6,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":72}],"buffers":[{"uri":"a%20square.bin","byteLength":72}]})");
}

void write_corners(const std::filesystem::path& folder, float size) {
  const std::array<float, 18> corners{0, 0, 0, size, 0, 0, size, size, 0, 0, 0, 0, size, size, 0, 0, size, 0};
  write_text(folder / "a square.bin",
             std::string(reinterpret_cast<const char*>(corners.data()), sizeof corners));
}

std::vector<std::string> watch(const std::string& scene, const std::string& file,
                               const std::vector<std::string>& options = {}) {
  std::vector<std::string> arguments{"watch", scene, "-o", file, "--quality", "64"};
  arguments.insert(arguments.end(), kCoarse.begin(), kCoarse.end());
  arguments.insert(arguments.end(), options.begin(), options.end());
  return relume_command(arguments);
}

TEST(Watch, PicksUpSavesOfTheSceneAndOfWhatItRefersTo) {
  const std::filesystem::path folder = fresh_folder();
  write_square(folder);
  write_corners(folder, 1.0f);
  Running watching(watch(folder / "square.gltf", folder / "a.relume", {"--json"}));
  ASSERT_TRUE(watching.wait_for_lines(1)) << watching.err();
  const std::string first = read_text(folder / "a.relume");
  write_corners(folder, 2.0f);  // in place
  ASSERT_TRUE(watching.wait_for_lines(2));
  EXPECT_NE(read_text(folder / "a.relume"), first);
  write_square(folder / "..");  // elsewhere, then renamed
  std::filesystem::rename(folder / ".." / "square.gltf", folder / "square.gltf");
  ASSERT_TRUE(watching.wait_for_lines(3));
  watching.signal(SIGINT);
  const Finished finished = watching.finish();
  EXPECT_EQ(finished.status, 0) << finished.err;
  std::istringstream lines(finished.out);
  std::vector<nlohmann::json> events;
  for (std::string line; std::getline(lines, line);) events.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(events.size(), 3u);
  EXPECT_TRUE(events[0].at("saved").empty());
  EXPECT_EQ(events[1].at("saved"), nlohmann::json({"a square.bin"}));
  EXPECT_EQ(events[1].at("changed"), "moved or changed: square");
  EXPECT_EQ(events[2].at("saved"), nlohmann::json({"square.gltf"}));
  EXPECT_EQ(events[2].at("changed"), "geometry as before");
  EXPECT_GT(events[1].at("traced_rays"), 0);
  EXPECT_EQ(events[2].at("traced_rays"), 0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 4);  // and a.relume.rows
}

TEST(Watch, ABrokenSceneIsOneSentenceAndTheLastGoodFileStays) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder), file = folder / "a.relume";
  const std::string good = read_text(scene);
  Running watching(watch(scene, file));
  ASSERT_TRUE(watching.wait_for_lines(1)) << watching.err();
  const std::string before = read_text(file);
  write_text(scene, "no scene");
  ASSERT_TRUE(watching.wait_for_error_lines(1));
  EXPECT_EQ(read_text(file), before);
  write_text(scene, good);
  ASSERT_TRUE(watching.wait_for_lines(2));
  watching.signal(SIGTERM);
  const Finished finished = watching.finish();
  EXPECT_EQ(finished.status, 0);
  EXPECT_THAT(finished.err, HasSubstr("furnace_box.glb"));
  EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  EXPECT_EQ(read_text(file), before);  // the same scene, the same bytes
}

TEST(Watch, ASaveDuringAPrecomputeStartsAnew) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("demo", folder), file = folder / "a.relume";
  // Minutes of work, if nothing stops it.
  Running watching(relume_command({"watch", scene, "-o", file, "--quality", "16384"}));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(watching.out(), "");
  write_square(folder);
  write_corners(folder, 0.2f);
  std::filesystem::rename(folder / "square.gltf", scene);
  ASSERT_TRUE(watching.wait_for_error_lines(1));  // JSON under a name that ends in .glb
  EXPECT_EQ(watching.out(), "");
  // Stopped while it is busy again.
  make_scene("demo", folder);
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  watching.signal(SIGINT);
  EXPECT_EQ(watching.finish().status, 0);
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(Watch, KilledAtAnyMomentLeavesTheOldFileOrTheNewOne) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder), file = folder / "a.relume";
  std::minstd_rand random(1);
  const int points = repeats("RELUME_KILL_POINTS", 4);
  std::string before, after;
  for (const std::string seed : {"0", "1"}) {
    Running once(watch(scene, file, {"--seed", seed}));
    ASSERT_TRUE(once.wait_for_lines(1));
    (seed == "0" ? before : after) = read_text(file);
  }
  ASSERT_NE(before, after);
  for (int i = 0; i < points; ++i) {
    write_text(file, before);
    Running watching(watch(scene, file, {"--seed", "1"}));
    std::this_thread::sleep_for(
        std::chrono::microseconds(std::uniform_int_distribution<int>(0, 150'000)(random)));
    watching.signal(SIGKILL);
    EXPECT_EQ(watching.finish().status, 128 + SIGKILL);
    const std::string left = read_text(file);
    ASSERT_TRUE(left == before || left == after) << left.size() << " bytes";
  }
}

TEST(Watch, OfNoSceneDoesNotBegin) {
  const std::filesystem::path folder = fresh_folder();
  const Finished refused = run_relume({"watch", folder / "none.glb", "-o", folder / "a.relume"});
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err, HasSubstr("none.glb"));
  EXPECT_EQ(run_relume({"watch", folder / "none.glb"}).status, 2);
}

}  // namespace
}  // namespace relume::test
