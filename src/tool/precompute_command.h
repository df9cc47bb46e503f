// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "core/model.h"
#include "precompute/precompute.h"
#include "tool/console.h"
#include "tool/model_summary.h"

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

/// What a precompute left in its file.
struct PrecomputedFile {
  Model model;
  PrecomputeReport report;
  ModelSummary summary;
  std::uint64_t bytes = 0;
};

/// Reads the scene, precomputes and writes. Warnings go to `console`. Cancelled when interrupted, or when
/// `go_on` (asked now and then) returns false; then nothing is written.
Result<PrecomputedFile> precompute_to_file(const PrecomputeArguments& arguments, Console& console,
                                           const std::function<bool()>& go_on = {});

/// Whether the output can be written: its folder exists, and it is no folder itself.
Result<void> check_output(const std::filesystem::path& output);

/// `relume precompute`. The exit status, or the error that ended it.
Result<int> run(const PrecomputeArguments& arguments, Console& console);

}  // namespace relume
