// SPDX-License-Identifier: MIT
//
// JSON to be written, as plain values; keeps the heavy JSON header out of the commands.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/quantities.h"

namespace relume {

struct JsonValue;
using JsonArray = std::vector<JsonValue>;
using JsonObject = std::vector<std::pair<std::string, JsonValue>>;  ///< in the order of writing

struct JsonValue {
  std::variant<std::nullptr_t, bool, double, std::int64_t, std::uint64_t, std::string, JsonArray, JsonObject>
      value;

  JsonValue() : value(nullptr) {}
  JsonValue(bool b) : value(b) {}
  JsonValue(double number) : value(number) {}
  JsonValue(int number) : value(std::int64_t{number}) {}
  JsonValue(std::uint32_t number) : value(std::uint64_t{number}) {}
  JsonValue(std::uint64_t number) : value(number) {}
  JsonValue(const char* text) : value(std::string(text)) {}
  JsonValue(std::string text) : value(std::move(text)) {}
  JsonValue(const std::filesystem::path& path) : value(path.string()) {}
  JsonValue(JsonArray array) : value(std::move(array)) {}
  JsonValue(JsonObject object) : value(std::move(object)) {}
  JsonValue(const Rgb& rgb) : value(JsonArray{rgb.x, rgb.y, rgb.z}) {}
};

/// Array of whatever a JsonValue can be made from.
template <class Range>
JsonArray json_array(const Range& range) {
  return JsonArray(range.begin(), range.end());
}

/// UTF-8 text, indented by two spaces, without a final newline. Numbers that are not finite become null;
/// bytes that are not UTF-8 are replaced.
std::string to_json_text(const JsonObject& object);

/// The same in one line.
std::string to_json_line(const JsonObject& object);

}  // namespace relume
