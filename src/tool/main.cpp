// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <new>

#include "precompute/process_memory.h"
#include "tool/arguments.h"
#include "tool/interrupt.h"

namespace relume {
namespace {

Result<int> run_guarded(const CommandArguments& command, Console& console) {
  try {
    return std::visit([&](const auto& arguments) { return run(arguments, console); }, command);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory,
                fmt::format("memory ran out: expected more than {:.0f} MB, found less",
                            1e-6 * double(peak_address_bytes())));
  } catch (const std::exception& error) {
    return fail(ErrorCode::bad_input, std::string("An error that nothing foresaw: ") + error.what() + ".");
  }
}

int fail_with(Console& console, const Error& error) {
  console.fail(error);
  return static_cast<int>(error.code);
}

/// Of a program that is cut off: as if it had ended with the error `cancelled`; watching just ends.
LastWords last_words(const ParsedArguments& arguments) {
  if (std::holds_alternative<WatchArguments>(arguments.command)) return {};
  const Error error{ErrorCode::cancelled, kStoppedSentence};
  const std::string clear_line = isatty(STDERR_FILENO) != 0 ? "\r\x1b[K" : "";
  return {arguments.mode.json ? error_text(error) : "", clear_line + "relume: " + error.message + "\n",
          static_cast<int>(error.code)};
}

int run_program(int count, const char* const* values) {
  const auto parsed = parse_arguments(count, values);
  if (!parsed) {
    Console console(console_mode(count, values));
    return fail_with(console, parsed.error());
  }
  if (const auto* help = std::get_if<HelpText>(&*parsed)) {
    std::fputs(help->text.c_str(), stdout);
    return 0;
  }
  const auto& arguments = std::get<ParsedArguments>(*parsed);
  Console console(arguments.mode);
  watch_interrupts(last_words(arguments));
  const Result<int> status = run_guarded(arguments.command, console);
  let_finish();
  return status ? *status : fail_with(console, status.error());
}

}  // namespace
}  // namespace relume

int main(int count, char** values) {
  const int status = relume::run_program(count, values);
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    std::fputs("relume: standard output could not be written.\n", stderr);
    return status == 0 ? static_cast<int>(relume::ErrorCode::out_of_memory) : status;
  }
  return status;
}
