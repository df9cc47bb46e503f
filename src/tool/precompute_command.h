// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "precompute/precompute.h"
#include "tool/console.h"

namespace relume {

struct PrecomputeArguments {
  std::filesystem::path scene;
  std::filesystem::path output;
  bool dry_run = false;       ///< nothing is written, and `output` may be empty
  PrecomputeOptions options;  ///< without sensors
  std::optional<std::filesystem::path> sensors;
};

/// `relume precompute`. The exit status, or the error that ended it.
Result<int> run(const PrecomputeArguments& arguments, Console& console);

}  // namespace relume
