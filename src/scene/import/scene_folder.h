// SPDX-License-Identifier: MIT
//
// The only door through which the importer reads files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace relume {

/// The bytes of a regular file of at most `max_bytes`. Errors: bad_input, or out_of_memory.
Result<std::vector<std::byte>> read_regular_file(const std::filesystem::path& file, std::uint64_t max_bytes);

/// Where the file that `uri` names should be; nothing for data URIs and paths that read_uri refuses.
std::optional<std::filesystem::path> named_file(const std::filesystem::path& scene_file,
                                                std::string_view uri);

/// Reads what `uri` of `scene_file` at JSON path `place` names: a data URI, or a percent-encoded path that is
/// relative, has no scheme, no ".." and no NUL, and stays inside the folder of the scene file after links are
/// resolved.
Result<std::vector<std::byte>> read_uri(const std::filesystem::path& scene_file, std::string_view place,
                                        std::string_view uri, std::uint64_t max_bytes);

}  // namespace relume
