// SPDX-License-Identifier: MIT
//
// What the program says: results on standard output, everything else on standard error.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "tool/json_value.h"

namespace relume {

struct ConsoleMode {
  bool json = false;   ///< one JSON object on standard output, nothing else there
  bool quiet = false;  ///< no summary, warnings or progress
};

class Console {
 public:
  explicit Console(ConsoleMode mode);

  /// A line of the summary for people: printed on standard output unless the mode is json or quiet.
  void say(std::string_view line);

  /// Printed on standard error unless quiet, and kept for the JSON object.
  void warn(std::string warning);

  /// Updates the progress line with the time left, when standard error is a terminal and the mode is not
  /// quiet.
  void progress(std::string_view stage, double fraction);

  /// Removes the progress line. Every other call does so too.
  void end_progress();

  /// Ends a command: prints `object`, with the warnings as its last member, when the mode is json.
  void finish(JsonObject object);

  /// Something that happened while a command goes on: prints `object` as one line when the mode is json.
  void event(const JsonObject& object);

  /// An error after which the command goes on: the sentence on standard error, and as an event.
  void complain(const Error& error);

  /// Ends a command that failed: the sentence on standard error, and as {"error", "exit"} on standard output
  /// in json mode.
  void fail(const Error& error);

  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  using Clock = std::chrono::steady_clock;
  ConsoleMode mode_;
  bool shows_progress_;
  bool line_open_ = false;
  std::string stage_;
  Clock::time_point stage_start_{};
  Clock::time_point last_update_{};
  std::vector<std::string> warnings_;
};

/// What `fail` prints on standard output with --json.
std::string error_text(const Error& error);

}  // namespace relume
