// SPDX-License-Identifier: MIT
//
// Kinds of options of the command line: what each takes, and the sentence when it gets anything else
// (CLI::ValidationError, for arguments.cpp to catch).
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace relume {

std::optional<double> parse_number(const std::string& text);
/// "2%" or "0.02".
std::optional<double> parse_share(const std::string& text);
/// "500M", "2G" or plain bytes.
std::optional<double> parse_bytes(const std::string& text);

/// Which numbers an option takes, and how it calls them.
struct NumberKind {
  const char* metavar;
  std::optional<double> (*parse)(const std::string&);
  double least;
  double most;
  bool whole;
  const char* expected;

  bool accepts(double number) const {
    return number >= least && number <= most && (!whole || number == std::floor(number));
  }
};

inline constexpr double kTiny = 1e-30;
inline constexpr double kLargestCount = 4294967295.0;
inline constexpr NumberKind kLengthOption{"M",  parse_number, kTiny,
                                          1e12, false,        "a length above 0 in metres"};
inline constexpr NumberKind kShareOption{"E",  parse_share, kTiny,
                                         1e12, false,       "a relative error above 0, as 0.01 or 1%"};
inline constexpr NumberKind kTargetOption{
    "E", parse_share, kTiny, 0.9999, false, "a relative error above 0 and below 100%, as 0.02 or 2%"};
inline constexpr NumberKind kAlbedoOption{"A",    parse_number, kTiny,
                                          0.9999, false,        "a number above 0, at most 0.9999"};
inline constexpr NumberKind kRadiosityOption{"LM/M2", parse_number, 0.0,
                                             1e30,    false,        "a number of at least 0"};
inline constexpr NumberKind kCountOption{"N",           parse_number, 1.0,
                                         kLargestCount, true,         "a whole number of at least 1"};
inline constexpr NumberKind kBytesOption{"BYTES", parse_bytes, 1.0,
                                         1e18,    true,        "a number of bytes, as 500M or 2G"};
inline constexpr NumberKind kCountOrZeroOption{"N",           parse_number, 0.0,
                                               kLargestCount, true,         "a whole number of at least 0"};

using Take = std::function<void(const std::string&)>;

CLI::Option* add_text(CLI::App& app, const std::string& name, const std::string& metavar, const Take& take,
                      const std::string& help);

template <class Target>
CLI::Option* add_number(CLI::App& app, const std::string& name, Target& target, const NumberKind& kind,
                        const std::string& help) {
  const auto take = [name, &target, &kind](const std::string& text) {
    const std::optional<double> number = kind.parse(text);
    if (!number || !kind.accepts(*number)) {
      throw CLI::ValidationError(name, fmt::format("expected {}, found '{}'", kind.expected, text));
    }
    target = Target(*number);
  };
  return add_text(app, name, kind.metavar, take, help);
}

/// `Path` is a path or an optional one.
template <class Path>
CLI::Option* add_path(CLI::App& app, const std::string& name, const std::string& metavar, Path& path,
                      const std::string& help) {
  return add_text(
      app, name, metavar, [&path](const std::string& text) { path = std::filesystem::path(text); }, help);
}

/// The index of `text` among `words`.
std::size_t choose(const std::string& name, const std::vector<std::string>& words, const std::string& text);

/// One of several words; `take` gets the index of the word.
CLI::Option* add_choice(CLI::App& app, const std::string& name, const std::vector<std::string>& words,
                        const std::function<void(std::size_t)>& take, const std::string& help);

}  // namespace relume
