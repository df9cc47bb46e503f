// SPDX-License-Identifier: MIT
//
// Every complaint about a scene file has one form: file, place in it, what was expected, what was found.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/result.h"

namespace relume {

/// "room.gltf: /accessors/3/count: expected an integer of at least 1, found 0". `place` is a JSON path or
/// "byte N".
inline tl::unexpected<Error> import_error(std::string_view file, std::string_view place,
                                          std::string_view expected, std::string_view found) {
  std::string message;
  message.append(file).append(": ").append(place).append(": expected ").append(expected);
  return fail(ErrorCode::bad_input, message.append(", found ").append(found));
}

/// "/accessors/3": a JSON path of one array element.
inline std::string json_path(std::string_view array, std::uint64_t index) {
  return std::string("/").append(array).append("/").append(std::to_string(index));
}

}  // namespace relume
