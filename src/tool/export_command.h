// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
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
  std::optional<glm::dvec3> at;    ///< world space, m: the receiver whose form factors are drawn
};

/// `relume export`: matrices, geometry and debug pictures of a model for other programs.
Result<int> run(const ExportArguments& arguments, Console& console);

}  // namespace relume
