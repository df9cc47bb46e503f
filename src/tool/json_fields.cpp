// SPDX-License-Identifier: MIT
#include "tool/json_fields.h"

#include <fmt/format.h>

#include <algorithm>

#include "tool/text_file.h"

namespace relume {
namespace {

const Json kNull;

std::string shown(const Json& json) {
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

std::string range_text(NumberRange range) {
  return range.most < 1e30 ? fmt::format("from {} to {}", range.least, range.most)
                           : fmt::format("of at least {}", range.least);
}

bool in_range(const Json& json, NumberRange range) {
  if (!json.is_number()) return false;
  const double value = json.get<double>();
  return value >= range.least && value <= range.most;
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

Result<Json> read_json_file(const std::filesystem::path& file) {
  const Result<std::string> text = read_text_file(file);
  if (!text) return tl::unexpected(text.error());
  // The parser recurses with the depth of the text.
  Json::parser_callback_t shallow = [](int depth, Json::parse_event_t, Json&) {
    if (depth > 64) throw std::length_error("nested deeper than 64 levels");
    return true;
  };
  try {
    return Json::parse(*text, shallow);
  } catch (const Json::parse_error& error) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: byte {}: expected JSON, found a syntax error.", file.string(), error.byte));
  } catch (const std::exception& error) {
    return fail(ErrorCode::bad_input,
                fmt::format("{}: expected JSON, found {}.", file.string(), error.what()));
  }
}

std::string json_name(const std::string& name) {
  const std::string quoted = Json(name).dump(-1, ' ', false, Json::error_handler_t::replace);
  return quoted.substr(1, quoted.size() - 2);
}

std::string json_path(std::string_view path, std::size_t index) {
  return fmt::format("{}/{}", path, index);
}

JsonFields::JsonFields(const Json& json, std::string file, std::string path)
    : json_(&json), file_(std::move(file)), path_(std::move(path)) {
  if (json.is_object()) return;
  json_ = &kNull;
  error_ =
      fmt::format("{}: {}: expected an object, found {}.", file_, path_.empty() ? "/" : path_, shown(json));
}

bool JsonFields::has(const std::string& key) const {
  return json_->is_object() && json_->contains(key);
}

const Json* JsonFields::find(const std::string& key) {
  asked_.push_back(key);
  return has(key) ? &(*json_)[key] : nullptr;
}

void JsonFields::reject(const std::string& key, std::string_view expected, std::string_view found) {
  if (error_) return;
  error_ = fmt::format("{}: {}/{}: expected {}, found {}.", file_, path_, json_name(key), expected, found);
}

void JsonFields::require(const std::string& key) {
  if (!has(key)) reject(key, "a value", "none");
}

double JsonFields::number(const std::string& key, double fallback, NumberRange range) {
  const Json* json = find(key);
  if (!json) return fallback;
  if (in_range(*json, range)) return json->get<double>();
  reject(key, "a number " + range_text(range), shown(*json));
  return fallback;
}

Rgb JsonFields::triple(const std::string& key, const Rgb& fallback, NumberRange range) {
  const Json* json = find(key);
  if (!json) return fallback;
  const auto fits = [&](const Json& entry) { return in_range(entry, range); };
  if (json->is_array() && json->size() == 3 && std::all_of(json->begin(), json->end(), fits)) {
    return Rgb((*json)[0].get<double>(), (*json)[1].get<double>(), (*json)[2].get<double>());
  }
  reject(key, "three numbers " + range_text(range), shown(*json));
  return fallback;
}

std::string JsonFields::text(const std::string& key, const std::string& fallback) {
  const Json* json = find(key);
  if (!json) return fallback;
  if (json->is_string()) return json->get<std::string>();
  reject(key, "a string", shown(*json));
  return fallback;
}

std::string JsonFields::one_of(const std::string& key, std::initializer_list<std::string_view> choices) {
  const std::string expected = fmt::format("one of {}", fmt::join(choices, ", "));
  const Json* json = find(key);
  if (json && json->is_string()) {
    const auto value = json->get<std::string>();
    if (std::find(choices.begin(), choices.end(), value) != choices.end()) return value;
  }
  reject(key, expected, json ? shown(*json) : "none");
  return std::string(*choices.begin());
}

const Json& JsonFields::compound(const std::string& key, bool is_array) {
  const Json* json = find(key);
  if (!json) return kNull;
  if (is_array ? json->is_array() : json->is_object()) return *json;
  reject(key, is_array ? "an array" : "an object", shown(*json));
  return kNull;
}

const Json& JsonFields::array(const std::string& key) {
  return compound(key, true);
}

const Json& JsonFields::object(const std::string& key) {
  return compound(key, false);
}

Result<void> JsonFields::finish() {
  if (!error_ && json_->is_object()) {
    for (const auto& member : json_->items()) {
      if (std::find(asked_.begin(), asked_.end(), member.key()) == asked_.end()) {
        reject(member.key(), "one of " + joined(asked_), "an unknown member");
      }
    }
  }
  if (error_) return fail(ErrorCode::bad_input, *error_);
  return {};
}

}  // namespace relume
