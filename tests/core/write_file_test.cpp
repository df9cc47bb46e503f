// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>

#include "core/model_file.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

std::span<const std::byte> as_bytes(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// An empty folder that goes away with the test.
class WriteFile : public testing::Test {
 protected:
  WriteFile() : folder_(fs::path(testing::TempDir()) / ("relume_write_file_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~WriteFile() override { fs::remove_all(folder_); }

  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator{}));
  }

  fs::path folder_;
};

/// Files of this process may not grow beyond a limit, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : previous_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &previous_);
    rlimit limit = previous_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &previous_);
    std::signal(SIGXFSZ, previous_handler_);
  }

 private:
  void (*previous_handler_)(int);
  rlimit previous_{};
};

TEST_F(WriteFile, WritesAndReplaces) {
  const fs::path file = folder_ / "a.bin";
  ASSERT_TRUE(write_file(file, as_bytes("first, and longer")));
  ASSERT_TRUE(write_file(file, as_bytes("second")));
  EXPECT_EQ(content_of(file), "second");
  ASSERT_TRUE(write_file(file, {}));
  EXPECT_EQ(content_of(file), "");
  EXPECT_EQ(files(), 1u) << "no temporary stays";
}

TEST_F(WriteFile, WritesPartsOneAfterTheOther) {
  const fs::path file = folder_ / "a.bin";
  std::vector<std::string> texts;  // more than go into one call; some are empty
  for (std::size_t i = 0; i < 2500; ++i) texts.emplace_back(i % 7, char('a' + i % 26));
  std::string all;
  std::vector<std::span<const std::byte>> parts;
  for (const std::string& text : texts) {
    all += text;
    parts.push_back(as_bytes(text));
  }
  ASSERT_TRUE(write_parts(file, parts));
  EXPECT_EQ(content_of(file), all);
}

TEST_F(WriteFile, KeepsTheOldFileWhenSpaceRunsOut) {
  const fs::path file = folder_ / "a.bin";
  ASSERT_TRUE(write_file(file, as_bytes("precious")));
  Result<void> written;
  {
    const FileSizeLimit limit(4096);
    written = write_file(file, as_bytes(std::string(100000, 'x')));
  }
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::out_of_memory);
  EXPECT_NE(written.error().message.find(file.string()), std::string::npos) << written.error().message;
  EXPECT_EQ(content_of(file), "precious");
  EXPECT_EQ(files(), 1u);
}

TEST_F(WriteFile, AFullDeviceIsCodeFive) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  const auto written = write_file("/dev/full", as_bytes("x"));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::out_of_memory);
  EXPECT_TRUE(fs::is_character_file("/dev/full")) << "devices are not replaced by files";
}

TEST_F(WriteFile, AMissingFolderAndAFolderAreWrongArguments) {
  const auto missing = write_file(folder_ / "none" / "a.bin", as_bytes("x"));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::usage);
  EXPECT_NE(missing.error().message.find("No such file or directory"), std::string::npos)
      << missing.error().message;
  const auto folder = write_file(folder_, as_bytes("x"));
  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().code, ErrorCode::usage);
}

TEST_F(WriteFile, LinksKeepPointingAtTheFile) {
  const fs::path file = folder_ / "a.bin";
  const fs::path link = folder_ / "link.bin";
  ASSERT_TRUE(write_file(file, as_bytes("old")));
  fs::create_symlink("a.bin", link);
  ASSERT_TRUE(write_file(link, as_bytes("new")));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(content_of(file), "new");
}

TEST_F(WriteFile, TemporariesOfAKilledProcessAreNoObstacle) {
  const fs::path stale = folder_ / (".relume-" + std::to_string(::getpid()) + "-0.tmp");
  std::ofstream(stale) << "half";
  ASSERT_TRUE(write_file(folder_ / "a.bin", as_bytes("whole")));
  EXPECT_EQ(content_of(folder_ / "a.bin"), "whole");
  EXPECT_EQ(content_of(stale), "half");
}

TEST_F(WriteFile, LongNamesAreFine) {
  const fs::path file = folder_ / std::string(255, 'n');
  ASSERT_TRUE(write_file(file, as_bytes("x")));
  EXPECT_EQ(content_of(file), "x");
}

}  // namespace
}  // namespace relume
