// SPDX-License-Identifier: MIT
//
// Runs programs the way a person does, and reads what they leave behind.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace relume::test {

struct Finished {
  int status = 0;  ///< exit status, 128 + signal when it was killed
  std::string out;
  std::string err;
};

/// A signal that a program gets once, so long after its start.
struct Interruption {
  int signal = 0;  ///< none
  std::chrono::microseconds after{};
};

/// A program that runs beside the test; killed when it goes out of scope.
class Running {
 public:
  explicit Running(const std::vector<std::string>& command, const std::vector<std::string>& environment = {});
  ~Running();
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  std::string out() const;  ///< so far
  std::string err() const;
  /// Waits until out() has so many lines, or 20 s; whether it has.
  bool wait_for_lines(std::size_t lines) const;
  bool wait_for_error_lines(std::size_t lines) const;
  void signal(int number) const;
  /// Waits for the end.
  Finished finish();

 private:
  std::string out_, err_;  ///< files
  int child_ = 0;          ///< 0: ended
};

/// Runs a program with arguments; `environment` (NAME=VALUE) replaces parts of ours.
Finished run_command(const std::vector<std::string>& command,
                     const std::vector<std::string>& environment = {}, const Interruption& interruption = {});

/// `relume` with arguments, as a command.
std::vector<std::string> relume_command(std::vector<std::string> arguments);

/// Runs `relume`.
Finished run_relume(std::vector<std::string> arguments, const std::vector<std::string>& environment = {},
                    const Interruption& interruption = {});

/// Runs `relume ... --json` and expects exit status 0 and one JSON object on standard output.
nlohmann::json relume_json(std::vector<std::string> arguments);

/// A new, empty folder; it is removed when the test program ends.
std::filesystem::path fresh_folder();

/// `relume-make-scene NAME` into `folder`; the path of the .glb.
std::string make_scene(const std::string& name, const std::filesystem::path& folder);

/// A precomputed scene in a folder of its own.
struct Precomputed {
  std::filesystem::path folder;
  std::string scene;
  std::string file;
};

/// `relume precompute` of a generated scene at 64 rays a lumel, with more options and, if given, the text of
/// a CSV of sensors.
Precomputed precomputed(const std::string& name, const std::vector<std::string>& options = {},
                        const std::string& sensors = "");

/// Options for a box of 1 m.
inline const std::vector<std::string> kCoarse{"--texel-size", "0.1", "--cluster-size", "0.25"};

/// `relume solve` by the reference into `result` of the folder; its JSON object.
nlohmann::json solve_json(const Precomputed& input, const std::vector<std::string>& options = {});

void write_text(const std::filesystem::path& file, const std::string& text);
std::string read_text(const std::filesystem::path& file);

/// Rows of a CSV by column name. The first line goes to `header`.
std::vector<std::map<std::string, std::string>> read_csv(const std::filesystem::path& file,
                                                         std::string& header);

}  // namespace relume::test
