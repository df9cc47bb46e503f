// SPDX-License-Identifier: MIT
//
// The command line as plain values. arguments.cpp is the only file that knows the library that parses it.
#pragma once

#include <filesystem>
#include <string>
#include <variant>

#include "tool/chart_command.h"
#include "tool/compare_command.h"
#include "tool/console.h"
#include "tool/export_command.h"
#include "tool/factors_command.h"
#include "tool/inspect_commands.h"
#include "tool/precompute_command.h"
#include "tool/solve_command.h"
#include "tool/watch_command.h"

namespace relume {

using CommandArguments =
    std::variant<PrecomputeArguments, WatchArguments, InfoArguments, CheckArguments, SolveArguments,
                 CompareArguments, FactorsArguments, ExportArguments, ChartArguments>;

struct ParsedArguments {
  CommandArguments command;
  ConsoleMode mode;
};

/// What is left to do when the command line asked for help or the version: print `text`, exit 0.
struct HelpText {
  std::string text;
};

/// Error (usage) in one sentence when an option or argument makes no sense. `--json` and `--quiet` are looked
/// up even then, see console_mode().
Result<std::variant<ParsedArguments, HelpText>> parse_arguments(int count, const char* const* values);

/// Whether `--json` or `--quiet` stand anywhere on the command line; for messages about a command line that
/// does not parse.
ConsoleMode console_mode(int count, const char* const* values);

}  // namespace relume
