// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace relume {

bool is_data_uri(std::string_view uri);

/// The bytes of "data:<type>;base64,<payload>" (RFC 2397, RFC 4648; padding may be missing). The error's
/// message says only what was found.
Result<std::vector<std::byte>> decode_data_uri(std::string_view uri);

}  // namespace relume
