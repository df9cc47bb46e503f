// SPDX-License-Identifier: MIT
#include "tool/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

namespace relume::test {
namespace {

std::vector<char*> pointers(const std::vector<std::string>& texts) {
  std::vector<char*> list;
  for (const std::string& text : texts) list.push_back(const_cast<char*>(text.c_str()));
  list.push_back(nullptr);
  return list;
}

/// Folders of one process; they go when it ends.
class TestFolders {
 public:
  TestFolders()
      : root_(std::filesystem::path(testing::TempDir()) / ("relume-tool-tests-" + std::to_string(getpid()))) {
  }
  ~TestFolders() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  TestFolders(const TestFolders&) = delete;
  TestFolders& operator=(const TestFolders&) = delete;

  std::filesystem::path make() {
    const std::filesystem::path folder = root_ / std::to_string(count_++);
    std::filesystem::create_directories(folder);
    return folder;
  }

 private:
  std::filesystem::path root_;
  int count_ = 0;
};

/// Our environment with `changes` (NAME=VALUE) in place of what has the same name.
std::vector<std::string> environment_with(const std::vector<std::string>& changes) {
  const auto name_of = [](const std::string& entry) { return entry.substr(0, entry.find('=')); };
  std::vector<std::string> all = changes;
  for (char** entry = environ; *entry; ++entry) {
    const auto same_name = [&](const std::string& change) { return name_of(change) == name_of(*entry); };
    if (std::none_of(changes.begin(), changes.end(), same_name)) all.emplace_back(*entry);
  }
  return all;
}

bool has_lines(const std::string& file, std::size_t lines) {
  constexpr int kTries = 2000;
  for (int i = 0; i < kTries; ++i) {
    const std::string text = read_text(file);
    if (std::size_t(std::count(text.begin(), text.end(), '\n')) >= lines) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

Running::Running(const std::vector<std::string>& command, const std::vector<std::string>& environment) {
  const std::filesystem::path folder = fresh_folder();
  out_ = folder / "out.txt";
  err_ = folder / "err.txt";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  // Lines are counted (RELUME_COVERAGE) in tests, not in programs that they start, which may be killed while
  // they write.
  std::vector<std::string> changes = environment;
  changes.emplace_back("LLVM_PROFILE_FILE=/dev/null");
  const std::vector<std::string> variables = environment_with(changes);
  const int failed = posix_spawn(&child_, command[0].c_str(), &actions, nullptr, pointers(command).data(),
                                 pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed == 0) return;
  child_ = 0;
  ADD_FAILURE() << command[0] << " could not be started";
}

Running::~Running() {
  if (child_ == 0) return;
  kill(child_, SIGKILL);
  waitpid(child_, nullptr, 0);
}

std::string Running::out() const {
  return read_text(out_);
}

std::string Running::err() const {
  return read_text(err_);
}

bool Running::wait_for_lines(std::size_t lines) const {
  return has_lines(out_, lines);
}

bool Running::wait_for_error_lines(std::size_t lines) const {
  return has_lines(err_, lines);
}

void Running::signal(int number) const {
  if (child_ != 0) kill(child_, number);
}

Finished Running::finish() {
  if (child_ == 0) return {};
  int status = 0;
  waitpid(child_, &status, 0);
  child_ = 0;
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), out(), err()};
}

Finished run_command(const std::vector<std::string>& command, const std::vector<std::string>& environment,
                     const Interruption& interruption) {
  Running running(command, environment);
  if (interruption.signal != 0) {
    std::this_thread::sleep_for(interruption.after);
    running.signal(interruption.signal);
  }
  return running.finish();
}

std::vector<std::string> relume_command(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), RELUME_PROGRAM);
  return arguments;
}

Finished run_relume(std::vector<std::string> arguments, const std::vector<std::string>& environment,
                    const Interruption& interruption) {
  return run_command(relume_command(std::move(arguments)), environment, interruption);
}

nlohmann::json relume_json(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const Finished finished = run_relume(arguments);
  EXPECT_EQ(finished.status, 0) << finished.err;
  nlohmann::json json = nlohmann::json::parse(finished.out, nullptr, false);
  EXPECT_TRUE(json.is_object()) << finished.out;
  return json;
}

std::filesystem::path fresh_folder() {
  static TestFolders folders;
  return folders.make();
}

std::string make_scene(const std::string& name, const std::filesystem::path& folder) {
  const std::string file = folder / (name + ".glb");
  EXPECT_EQ(run_command({RELUME_MAKE_SCENE, name, "-o", file}).status, 0);
  return file;
}

Precomputed precomputed(const std::string& name, const std::vector<std::string>& options,
                        const std::string& sensors) {
  Precomputed result;
  result.folder = fresh_folder();
  result.scene = make_scene(name, result.folder);
  result.file = result.folder / (name + ".relume");
  std::vector<std::string> command{"precompute", result.scene, "-o",     result.file,
                                   "--quality",  "64",         "--quiet"};
  command.insert(command.end(), options.begin(), options.end());
  if (!sensors.empty()) {
    write_text(result.folder / "sensors.csv", sensors);
    command.insert(command.end(), {"--sensors", result.folder / "sensors.csv"});
  }
  const Finished finished = run_relume(command);
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.out, "");
  return result;
}

nlohmann::json solve_json(const Precomputed& input, const std::vector<std::string>& options) {
  std::vector<std::string> command{"solve",    input.file, "-o", input.folder / "result",
                                   "--device", "reference"};
  command.insert(command.end(), options.begin(), options.end());
  return relume_json(command);
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::map<std::string, std::string>> read_csv(const std::filesystem::path& file,
                                                         std::string& header) {
  std::ifstream stream(file);
  std::getline(stream, header);
  const std::vector<std::string> names = split(header);
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(stream, line);) {
    const std::vector<std::string> cells = split(line);
    EXPECT_EQ(cells.size(), names.size()) << line;
    auto& row = rows.emplace_back();
    for (std::size_t c = 0; c < std::min(cells.size(), names.size()); ++c) row[names[c]] = cells[c];
  }
  return rows;
}

}  // namespace relume::test
