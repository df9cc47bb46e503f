// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

namespace relume::test {

/// The folder of scenes and truth data beside the repository (RELUME_SHARED_DIR, else ../shared), or nothing
/// where it is missing.
std::optional<std::filesystem::path> shared_files();

}  // namespace relume::test
