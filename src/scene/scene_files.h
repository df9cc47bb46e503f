// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

namespace relume {

/// The files that a scene is read from: `file` itself, then those that its buffers and images name, whether
/// they exist or not. Of a file that is no glTF as far as that, `file` alone.
std::vector<std::filesystem::path> scene_files(const std::filesystem::path& file);

}  // namespace relume
