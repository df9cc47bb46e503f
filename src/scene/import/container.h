// SPDX-License-Identifier: MIT
//
// .gltf and .glb from the outside: where the JSON is, where the binary chunk is, and that the JSON is not
// nested too deep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace relume {

/// Views into the bytes of a scene file.
struct GltfContainer {
  std::string_view json;
  std::size_t json_offset = 0;                       ///< of `json` in the file, bytes
  std::optional<std::span<const std::byte>> binary;  ///< BIN chunk of a .glb, may be empty
  std::vector<std::string> warnings;
};

/// Splits a file; one that starts with "glTF" or is called .glb must be a well-formed GLB 2. `file` is used
/// in messages.
Result<GltfContainer> split_container(std::span<const std::byte> bytes, const std::string& file);

/// Error when arrays and objects are nested deeper than `max_depth`. Looks at brackets outside of strings
/// only, so it is safe to run before any parser.
Result<void> check_json_depth(const GltfContainer& container, std::uint32_t max_depth,
                              const std::string& file);

}  // namespace relume
