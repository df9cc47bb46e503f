// SPDX-License-Identifier: MIT
//
// Ctrl-C. Long work asks a flag between steps and ends with the error `cancelled`. Where it does not come to
// that within 30 ms, the program ends by itself, with the same words and status: between two writes nothing
// that it has begun is left anywhere. A second Ctrl-C ends it at once.
#pragma once

#include <string>

#include "core/result.h"

namespace relume {

/// What a program that is cut off still says, and its exit status.
struct LastWords {
  std::string out, err;
  int status = 0;
};

/// Installs the handlers of SIGINT and SIGTERM. Call it once.
void watch_interrupts(LastWords words);

/// From now on nothing is cut off: files are on their way to the disk, or words to the screen.
void let_finish();

/// The opposite, for a program that works on after it has written.
void allow_cut();

bool interrupted();

/// Fails with `cancelled` when interrupted.
Result<void> check_interrupted();

/// The sentence of that error.
extern const char* const kStoppedSentence;

}  // namespace relume
