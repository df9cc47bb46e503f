// SPDX-License-Identifier: MIT
#include "tool/json_value.h"

#include <nlohmann/json.hpp>

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

Json convert(const JsonValue& value);

struct Converter {
  Json operator()(std::nullptr_t) const { return nullptr; }
  Json operator()(const JsonArray& array) const {
    Json json = Json::array();
    for (const JsonValue& entry : array) json.push_back(convert(entry));
    return json;
  }
  Json operator()(const JsonObject& object) const {
    Json json = Json::object();
    for (const auto& [key, entry] : object) json[key] = convert(entry);
    return json;
  }
  template <class Plain>
  Json operator()(const Plain& plain) const {
    return plain;
  }
};

Json convert(const JsonValue& value) {
  return std::visit(Converter{}, value.value);
}

}  // namespace

std::string to_json_text(const JsonObject& object) {
  return Converter{}(object).dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string to_json_line(const JsonObject& object) {
  return Converter{}(object).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace relume
