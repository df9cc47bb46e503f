// SPDX-License-Identifier: MIT
#include "tool/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace relume {
namespace {

constexpr std::chrono::milliseconds kUpdateInterval{100};

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string progress_line(std::string_view stage, double fraction, double seconds_elapsed) {
  std::string line = fmt::format("{} {:3.0f} %", stage, 100.0 * fraction);
  if (fraction > 0.01 && seconds_elapsed > 1.0) {
    line += fmt::format(", {} left", clock_text(seconds_elapsed * (1.0 - fraction) / fraction));
  }
  return line;
}

}  // namespace

Console::Console(ConsoleMode mode)
    : mode_(mode), shows_progress_(!mode.quiet && isatty(STDERR_FILENO) == 1) {}

void Console::say(std::string_view line) {
  if (mode_.json || mode_.quiet) return;
  end_progress();
  fmt::print(stdout, "{}\n", line);
  std::fflush(stdout);
}

void Console::warn(std::string warning) {
  end_progress();
  if (!mode_.quiet) fmt::print(stderr, "relume: warning: {}\n", warning);
  warnings_.push_back(std::move(warning));
}

void Console::progress(std::string_view stage, double fraction) {
  if (!shows_progress_) return;
  const auto now = Clock::now();
  if (stage != stage_) {
    stage_ = stage;
    stage_start_ = now;
    last_update_ = now;
    return;
  }
  if (now - last_update_ < kUpdateInterval) return;
  last_update_ = now;
  const double seconds = std::chrono::duration<double>(now - stage_start_).count();
  fmt::print(stderr, "\r\x1b[K{}", progress_line(stage, std::clamp(fraction, 0.0, 1.0), seconds));
  std::fflush(stderr);
  line_open_ = true;
}

void Console::end_progress() {
  if (!line_open_) return;
  fmt::print(stderr, "\r\x1b[K");
  line_open_ = false;
}

void Console::finish(JsonObject object) {
  end_progress();
  if (!mode_.json) return;
  object.emplace_back("warnings", json_array(warnings_));
  fmt::print(stdout, "{}\n", to_json_text(object));
}

void Console::event(const JsonObject& object) {
  end_progress();
  if (!mode_.json) return;
  fmt::print(stdout, "{}\n", to_json_line(object));
  std::fflush(stdout);
}

void Console::complain(const Error& error) {
  end_progress();
  fmt::print(stderr, "relume: {}\n", error.message);
  event({{"error", error.message}, {"exit", static_cast<int>(error.code)}});
}

void Console::fail(const Error& error) {
  end_progress();
  fmt::print(stderr, "relume: {}\n", error.message);
  if (!mode_.json) return;
  fmt::print(stdout, "{}", error_text(error));
}

std::string error_text(const Error& error) {
  return to_json_text({{"error", error.message}, {"exit", static_cast<int>(error.code)}}) + "\n";
}

}  // namespace relume
