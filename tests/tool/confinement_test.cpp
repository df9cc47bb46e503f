// SPDX-License-Identifier: MIT
//
// What a program takes from the machine that it runs on: no more memory than there is, no file beside its
// own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tool/program.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

/// `relume` where the process may have so many KiB of addresses.
Finished run_within(std::size_t kibibytes, const std::vector<std::string>& arguments) {
  std::vector<std::string> command{"/bin/sh", "-c",
                                   "ulimit -v " + std::to_string(kibibytes) + R"( && exec "$0" "$@")"};
  const std::vector<std::string> relume = relume_command(arguments);
  command.insert(command.end(), relume.begin(), relume.end());
  return run_command(command);
}

/// From too little for anything to enough: the file, or one sentence about memory.
void expect_file_or_sentence(const std::vector<std::string>& arguments) {
  int refused = 0, done = 0;
  for (std::size_t kibibytes = 100'000; kibibytes <= 500'000; kibibytes += 100'000) {
    const Finished finished = run_within(kibibytes, arguments);
    if (finished.status == 127) continue;  // too little for the libraries
    if (finished.status == 0) {
      ++done;
      continue;
    }
    ++refused;
    EXPECT_EQ(finished.status, 5) << kibibytes << " KiB: " << finished.err;
    EXPECT_THAT(finished.err, testing::ContainsRegex("memory.* expected .*[0-9]+ (MB|bytes)")) << kibibytes;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(done, 0);
}

TEST(AddressSpace, ThatIsTooSmallIsOneSentenceAndStatusFive) {
  if (run_within(2'000'000, {"--help"}).status != 0) GTEST_SKIP() << "sanitizers need all addresses";
  const Precomputed box = precomputed("furnace_box", kCoarse);
  std::vector<std::string> again{"precompute", box.scene, "-o", (box.folder / "again.relume").string(),
                                 "--quiet"};
  again.insert(again.end(), kCoarse.begin(), kCoarse.end());
  expect_file_or_sentence(again);
  expect_file_or_sentence(
      {"solve", box.file, "-o", (box.folder / "out").string(), "--device", "reference", "--quiet"});
}

/// Paths of files that were opened, and calls that start programs or connect, in the words of strace.
struct Trace {
  std::vector<std::string> opened, others;
};

Trace trace_of(const std::filesystem::path& log) {
  Trace trace;
  std::istringstream lines(read_text(log));
  for (std::string line; std::getline(lines, line);) {
    const bool failed = line.find(" = -1 ") != std::string::npos;
    const auto first = line.find('"'), last = first == std::string::npos ? first : line.find('"', first + 1);
    if (line.find("open") == std::string::npos || last == std::string::npos) {
      trace.others.push_back(line);
    } else if (!failed) {
      trace.opened.push_back(line.substr(first + 1, last - first - 1));
    }
  }
  return trace;
}

bool starts_with_any(const std::string& path, const std::vector<std::string>& starts) {
  return std::any_of(starts.begin(), starts.end(),
                     [&](const auto& start) { return path.rfind(start, 0) == 0; });
}

/// A scene of one triangle whose corners are in the file that `uri` names.
std::string triangle_from(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":")" +
         uri + R"("}]})";
}

// What libraries open to be loaded and to count processors is not the scene's doing.
TEST(Strace, SeesNoFileOutsideOfTheFolderOfAScene) {
  const std::string strace = "/usr/bin/strace";
  if (!std::filesystem::exists(strace)) GTEST_SKIP() << "there is no strace here";
  const std::filesystem::path folder = fresh_folder();
  std::filesystem::create_directory(folder / "scene");
  write_text(folder / "secret.bin", std::string(36, 's'));
  const std::string scene = folder / "scene" / "scene.gltf", log = folder / "log";
  for (const char* uri : {"../secret.bin", "..%2fsecret.bin", "a/../../secret.bin", "/etc/passwd",
                          "file:///etc/passwd", "`touch x`"}) {
    write_text(scene, triangle_from(uri));
    std::vector<std::string> command{
        strace, "-f", "-qq", "-o", log, "-e", "trace=open,openat,openat2,socket,connect,execve"};
    const auto relume = relume_command({"precompute", scene, "-o", (folder / "scene/out.relume").string()});
    command.insert(command.end(), relume.begin(), relume.end());
    const Finished finished = run_command(command);
    if (finished.err.find("ptrace") != std::string::npos) GTEST_SKIP() << "nobody may be traced here";
    EXPECT_EQ(finished.status, 3) << uri << ": " << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("buffers/0/uri")) << finished.err;
    const Trace trace = trace_of(log);
    EXPECT_THAT(trace.opened, testing::Contains(HasSubstr("scene.gltf")));
    for (const std::string& path : trace.opened) {
      EXPECT_TRUE(starts_with_any(
          path, {"/lib", "/usr/", "/etc/ld.so", "/proc/", "/sys/", "/dev/", folder / "scene"}))
          << uri << ": " << path;
    }
    EXPECT_LE(trace.others.size(), 1u) << testing::PrintToString(trace.others);  // its own start
  }
}

}  // namespace
}  // namespace relume::test
