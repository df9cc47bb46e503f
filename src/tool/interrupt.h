// SPDX-License-Identifier: MIT
//
// Ctrl-C as a flag. Long work asks it between steps and ends with the error `cancelled`; a second Ctrl-C ends
// the program at once.
#pragma once

#include "core/result.h"

namespace relume {

/// Installs the handlers of SIGINT and SIGTERM.
void watch_interrupts();

bool interrupted();

/// Fails with `cancelled` when interrupted.
Result<void> check_interrupted();

}  // namespace relume
