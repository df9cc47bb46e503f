// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tool/console.h"

namespace relume {

struct ExportArguments {
  std::filesystem::path file;
  std::filesystem::path output = ".";
  std::string matrices;  ///< "mtx", "npz" or empty
  bool glb = false;
  std::vector<std::string> debug;  ///< names of debug_view_names()
};

/// `relume export`: matrices, geometry and debug pictures of a model for other programs.
Result<int> run(const ExportArguments& arguments, Console& console);

}  // namespace relume
