// SPDX-License-Identifier: MIT
//
// A file of row kernels that were the fastest, one a line: key, kernel, fetch.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "compute/solver_options.h"

namespace relume {

/// What the file has for a key. Nothing when there is no such file or line, or it cannot be read.
std::optional<RowKernelChoice> read_kernel_cache(const std::filesystem::path& file, const std::string& key);

/// Makes the file, with its folder, or replaces its line for the key: written under another name and renamed,
/// so that programs may do so at once. Says whether it could.
bool write_kernel_cache(const std::filesystem::path& file, const std::string& key,
                        const RowKernelChoice& choice);

}  // namespace relume
