// SPDX-License-Identifier: MIT
//
// Reading a JSON file that a person wrote: every member is checked, an unknown one is an error, and the first
// error says file, JSON path, what was expected and what was found. Includes the heavy JSON header: for the
// readers of input files only.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/quantities.h"
#include "core/result.h"

namespace relume {

using Json = nlohmann::json;

/// bad_input when the file cannot be read or is not JSON.
Result<Json> read_json_file(const std::filesystem::path& file);

struct NumberRange {
  double least = 0.0;
  double most = 1e30;
};

/// The members of one object. After the first error the readers return their fallback; finish() tells it.
class JsonFields {
 public:
  /// `json` must outlive this; `path` is the JSON path of the object, "" at the top.
  JsonFields(const Json& json, std::string file, std::string path);

  bool has(const std::string& key) const;
  double number(const std::string& key, double fallback, NumberRange range);
  Rgb triple(const std::string& key, const Rgb& fallback, NumberRange range);
  std::string text(const std::string& key, const std::string& fallback);
  std::string one_of(const std::string& key, std::initializer_list<std::string_view> choices);
  /// The array or object `key`; null JSON when there is none.
  const Json& array(const std::string& key);
  const Json& object(const std::string& key);

  void require(const std::string& key);
  void reject(const std::string& key, std::string_view expected, std::string_view found);
  /// The first error; also one when the object has a member that no reader asked for.
  Result<void> finish();

 private:
  const Json* find(const std::string& key);
  const Json& compound(const std::string& key, bool is_array);

  const Json* json_;
  std::string file_;
  std::string path_;
  std::vector<std::string> asked_;
  std::optional<std::string> error_;
};

/// A name as JSON writes it, without its quotes: whatever is in it, in one line.
std::string json_name(const std::string& name);

/// JSON path of entry `index` of the array at `path`.
std::string json_path(std::string_view path, std::size_t index);

}  // namespace relume
