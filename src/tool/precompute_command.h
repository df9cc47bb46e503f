// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "precompute/precompute.h"
#include "tool/console.h"

namespace relume {

struct PrecomputeArguments {
  std::filesystem::path scene;
  std::filesystem::path output;
  bool dry_run = false;       ///< nothing is written, and `output` may be empty
  PrecomputeOptions options;  ///< without sensors and probes
  std::optional<std::filesystem::path> sensors;
  std::string probes = "none";                  ///< or auto, or a spacing in metres, or a CSV
  std::optional<std::filesystem::path> update;  ///< an earlier model, whose rows lie beside it
};

/// `relume precompute`. The exit status, or the error that ended it.
Result<int> run(const PrecomputeArguments& arguments, Console& console);

}  // namespace relume
