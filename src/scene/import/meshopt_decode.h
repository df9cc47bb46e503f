// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace relume {

/// A view under EXT_meshopt_compression, as its JSON says.
struct CompressedView {
  std::string_view mode;    ///< ATTRIBUTES, TRIANGLES or INDICES
  std::string_view filter;  ///< NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL
  std::size_t count = 0;
  std::size_t stride = 0;  ///< bytes
};

/// count x stride bytes. The decoder is safe for any input but may give any indices: they are checked with
/// all others. `place` is the JSON path of the extension.
Result<std::vector<std::byte>> decode_compressed_view(const CompressedView& view,
                                                      std::span<const std::byte> packed,
                                                      const std::string& file, std::string_view place);

}  // namespace relume
