// SPDX-License-Identifier: MIT
#include "tool/json_value.h"

#include <nlohmann/json.hpp>

namespace relume {
namespace {

using OutputJson = nlohmann::ordered_json;

OutputJson convert(const JsonValue& value);

struct Converter {
  OutputJson operator()(std::nullptr_t) const { return nullptr; }
  OutputJson operator()(const JsonArray& array) const {
    OutputJson json = OutputJson::array();
    for (const JsonValue& entry : array) json.push_back(convert(entry));
    return json;
  }
  OutputJson operator()(const JsonObject& object) const {
    OutputJson json = OutputJson::object();
    for (const auto& [key, entry] : object) json[key] = convert(entry);
    return json;
  }
  template <class Plain>
  OutputJson operator()(const Plain& plain) const {
    return plain;
  }
};

OutputJson convert(const JsonValue& value) {
  return std::visit(Converter{}, value.value);
}

}  // namespace

std::string to_json_text(const JsonObject& object) {
  return Converter{}(object).dump(2, ' ', false, OutputJson::error_handler_t::replace);
}

std::string to_json_line(const JsonObject& object) {
  return Converter{}(object).dump(-1, ' ', false, OutputJson::error_handler_t::replace);
}

}  // namespace relume
