// SPDX-License-Identifier: MIT
//
// Short words for reading a document that has passed check_rules.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

namespace relume {

/// A member that is an array, or an empty one.
inline const nlohmann::json& array_of(const nlohmann::json& object, const char* name) {
  static const nlohmann::json empty = nlohmann::json::array();
  const auto member = object.find(name);
  return member == object.end() ? empty : *member;
}

/// An index, count, offset or length, or 0.
inline std::uint64_t size_of(const nlohmann::json& object, const char* name) {
  return object.value(name, std::uint64_t{0});
}

/// object.extensions[name], or nothing.
inline const nlohmann::json* extension_of(const nlohmann::json& object, const char* name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end()) return nullptr;
  const auto extension = extensions->find(name);
  return extension == extensions->end() ? nullptr : &*extension;
}

}  // namespace relume
