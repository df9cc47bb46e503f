// SPDX-License-Identifier: MIT
#include "scene/import/data_uri.h"

#include <cstdint>
#include <new>
#include <string>

namespace relume {
namespace {

constexpr std::string_view kMarker = ";base64,";

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

}  // namespace

bool is_data_uri(std::string_view uri) {
  return uri.substr(0, 5) == "data:";
}

Result<std::vector<std::byte>> decode_data_uri(std::string_view uri) {
  const auto comma = uri.find(',');
  const auto marker = uri.find(kMarker);
  if (marker == std::string_view::npos || marker + kMarker.size() - 1 != comma) {
    return fail(ErrorCode::bad_input, "a data URI without \";base64,\"");
  }
  std::string_view payload = uri.substr(comma + 1);
  while (!payload.empty() && payload.back() == '=') payload.remove_suffix(1);
  if (payload.size() % 4 == 1) return fail(ErrorCode::bad_input, "a payload that is cut short");
  std::vector<std::byte> bytes;
  try {
    bytes.reserve(payload.size() / 4 * 3 + 2);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, "no memory for its payload");
  }
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (std::size_t i = 0; i < payload.size(); ++i) {
    const int value = base64_value(payload[i]);
    if (value < 0) {
      return fail(ErrorCode::bad_input,
                  "a character that is not base64 at offset " + std::to_string(comma + 1 + i));
    }
    bits = (bits << 6) | static_cast<std::uint32_t>(value);
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      bytes.push_back(static_cast<std::byte>((bits >> bit_count) & 0xffu));
    }
  }
  return bytes;
}

}  // namespace relume
