// SPDX-License-Identifier: MIT
#include "tool/text_file.h"

#include <fmt/format.h>

#include <fstream>

namespace relume {
namespace {

constexpr std::uintmax_t kMaxTextBytes = std::uintmax_t{64} << 20;

}  // namespace

Result<std::string> read_text_file(const std::filesystem::path& file) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(file, code)) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: expected a readable file, found none.", file.string()));
  }
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  if (code || size > kMaxTextBytes) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: expected at most {} bytes, found {}.", file.string(), kMaxTextBytes, size));
  }
  std::ifstream stream(file, std::ios::binary);
  std::string text(size, '\0');
  if (!stream.read(text.data(), static_cast<std::streamsize>(size))) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: expected {} readable bytes, found fewer.", file.string(), size));
  }
  return text;
}

}  // namespace relume
