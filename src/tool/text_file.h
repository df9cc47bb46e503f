// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "core/result.h"

namespace relume {

/// A whole regular file of at most 64 MiB. bad_input when it cannot be read.
Result<std::string> read_text_file(const std::filesystem::path& file);

}  // namespace relume
