// SPDX-License-Identifier: MIT
//
// Files that somebody may save, asked for their times now and then: that works on every file system, and for
// editors that write in place as for those that write another file and rename it.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace relume {

/// What tells a saved file from the one before; all 0 of a file that is not there.
struct FileState {
  std::filesystem::path file;
  std::int64_t nanoseconds = 0;  ///< of the last change
  std::uint64_t bytes = 0;
  std::uint64_t number = 0;  ///< of the inode
  friend bool operator==(const FileState&, const FileState&) = default;
};

std::vector<FileState> states_of(const std::vector<std::filesystem::path>& files);

class WatchedFiles {
 public:
  /// `files` names them; what they refer to may change as they do.
  explicit WatchedFiles(std::function<std::vector<std::filesystem::path>()> files)
      : files_(std::move(files)) {}

  /// Waits until some are other than they were when this returned last, and then until nothing was saved for
  /// a moment. At once the first time. False when `go_on`, asked now and then, says so.
  bool wait(const std::function<bool()>& go_on);

  /// Names of the files that were saved before wait() returned; none the first time.
  const std::vector<std::string>& saved() const { return saved_; }

  /// Whether any was saved since wait() returned.
  bool changed();
  /// The same for whoever asks often: looks at most twenty times a second.
  bool changed_lately();

 private:
  void note(std::vector<FileState> now);

  std::function<std::vector<std::filesystem::path>()> files_;
  std::vector<FileState> states_;  ///< when wait() returned
  std::vector<std::string> saved_;
  bool changed_ = false;
  std::chrono::steady_clock::time_point looked_{};
};

}  // namespace relume
