// SPDX-License-Identifier: MIT
#include "tool/watched_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <thread>

namespace relume {
namespace {

constexpr std::chrono::milliseconds kInterval{50};
/// So long nothing must be saved before a save counts as done.
constexpr std::chrono::milliseconds kQuiet{150};

std::vector<std::filesystem::path> paths_of(const std::vector<FileState>& states) {
  std::vector<std::filesystem::path> paths;
  for (const FileState& state : states) paths.push_back(state.file);
  return paths;
}

}  // namespace

std::vector<FileState> states_of(const std::vector<std::filesystem::path>& files) {
  std::vector<FileState> states;
  for (const std::filesystem::path& file : files) {
    FileState& state = states.emplace_back();
    state.file = file;
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) continue;
    state.nanoseconds = 1'000'000'000 * std::int64_t{status.st_mtim.tv_sec} + status.st_mtim.tv_nsec;
    state.bytes = static_cast<std::uint64_t>(status.st_size);
    state.number = static_cast<std::uint64_t>(status.st_ino);
  }
  return states;
}

bool WatchedFiles::wait(const std::function<bool()>& go_on) {
  if (states_.empty()) {
    states_ = states_of(files_());
    return go_on();
  }
  std::vector<FileState> last = states_of(paths_of(states_));
  auto since = std::chrono::steady_clock::now();
  bool settled = false;
  while (!settled) {
    if (!go_on()) return false;
    std::this_thread::sleep_for(kInterval);
    std::vector<FileState> now = states_of(paths_of(states_));
    if (now != last) since = std::chrono::steady_clock::now();
    last = std::move(now);
    settled = last != states_ && std::chrono::steady_clock::now() - since >= kQuiet;
  }
  note(std::move(last));
  return true;
}

bool WatchedFiles::changed() {
  looked_ = std::chrono::steady_clock::now();
  changed_ = changed_ || states_of(paths_of(states_)) != states_;
  return changed_;
}

bool WatchedFiles::changed_lately() {
  return changed_ || (std::chrono::steady_clock::now() - looked_ >= kInterval && changed());
}

void WatchedFiles::note(std::vector<FileState> now) {
  saved_.clear();
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (!(now[i] == states_[i])) saved_.push_back(now[i].file.filename().string());
  }
  states_ = std::move(now);
  // What is new among the files comes with the state that it has now; the others keep theirs, so that no
  // save between goes unseen.
  for (FileState& state : states_of(files_())) {
    const auto same = [&](const FileState& known) { return known.file == state.file; };
    if (std::none_of(states_.begin(), states_.end(), same)) states_.push_back(std::move(state));
  }
  changed_ = false;
}

}  // namespace relume
