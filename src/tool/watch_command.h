// SPDX-License-Identifier: MIT
#pragma once

#include "tool/console.h"
#include "tool/precompute_command.h"

namespace relume {

struct WatchArguments {
  PrecomputeArguments precompute;
};

/// `relume watch`: precomputes, and again whenever the scene, a file that it refers to, or a CSV is saved,
/// until interrupted; each time but the first only the rays that the save may have changed (--update;
/// FILE.rows lies beside the output). A save during a precompute ends that one and starts anew. The output is
/// replaced whole or not at all; a scene that cannot be precomputed is complained about, and the last good
/// file stays. Prints a line for each precompute; in json mode an object in one line. 0, or why it could not
/// begin.
Result<int> run(const WatchArguments& arguments, Console& console);

}  // namespace relume
