// SPDX-License-Identifier: MIT
#include "fuzz/input_file.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace relume::test {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("relume_fuzz_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

}  // namespace

fs::path input_file(const std::string& name, const std::uint8_t* bytes, std::size_t size) {
  static const Folder folder;
  const fs::path file = folder.path / name;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  return file;
}

void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

void require_one_line(const Error& error, const std::string& name) {
  require(error.code == ErrorCode::bad_input || error.code == ErrorCode::check_failed,
          "bad input is told as such");
  require(error.message.find('\n') == std::string::npos, "an error is one line");
  require(error.message.find(name) != std::string::npos, "an error names the file");
}

}  // namespace relume::test
