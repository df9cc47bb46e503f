// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"

namespace relume {

/// Files that a command made, kept in memory until all of them are ready: a command that fails or is stopped
/// leaves nothing behind.
class OutputFolder {
 public:
  explicit OutputFolder(std::filesystem::path folder);

  /// `name` is relative to the folder, with '/' between subfolders.
  void add(const std::string& name, std::vector<std::byte> bytes);
  void add(const std::string& name, const std::string& text);
  /// Passes the error of an encoder on.
  Result<void> add(const std::string& name, Result<std::vector<std::byte>> bytes);

  /// Makes the folders and writes every file whole. Fails when interrupted before the first.
  Result<void> write() const;

  /// Paths written, in the order of adding.
  std::vector<std::filesystem::path> paths() const;

 private:
  struct File {
    std::filesystem::path path;
    std::vector<std::byte> bytes;
  };
  std::filesystem::path folder_;
  std::vector<File> files_;
};

}  // namespace relume
