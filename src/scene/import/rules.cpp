// SPDX-License-Identifier: MIT
#include "scene/import/rules.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "scene/import/import_error.h"
#include "scene/import/rule_table.h"

namespace relume {
namespace {

using Json = nlohmann::json;

/// Where the walk stands; the text of the path is only made for a message.
struct Place {
  const Place* parent;
  std::string_view key;
  std::size_t element;  ///< used when `key` is empty
};

std::string path_of(const Place* place) {
  if (!place) return "";
  return path_of(place->parent) + "/" +
         (place->key.empty() ? std::to_string(place->element) : std::string(place->key));
}

std::string described(const Json& value) {
  if (value.is_object()) return fmt::format("an object with {} members", value.size());
  if (value.is_array()) return fmt::format("an array of {} values", value.size());
  const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  return text.size() > 80 ? text.substr(0, 80) + "..." : text;
}

const Json* find_path(const Json& document, std::string_view path) {
  const Json* at = &document;
  while (!path.empty()) {
    const auto slash = path.find('/');
    if (!at->is_object()) return nullptr;
    const auto member = at->find(path.substr(0, slash));
    if (member == at->end()) return nullptr;
    at = &*member;
    path = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
  }
  return at;
}

bool is_one_of(std::string_view value, std::string_view allowed) {
  while (!allowed.empty()) {
    const auto bar = allowed.find('|');
    if (allowed.substr(0, bar) == value) return true;
    allowed = bar == std::string_view::npos ? std::string_view() : allowed.substr(bar + 1);
  }
  return false;
}

bool is_in_range(const Json& value, const Rule& rule) {
  const double number = value.get<double>();
  return std::isfinite(number) && number >= rule.min && number <= rule.max;
}

bool is_numbers(const Json& value, std::size_t length) {
  if (!value.is_array() || (length != 0 && value.size() != length)) return false;
  for (const Json& element : value) {
    if (!element.is_number()) return false;
  }
  return true;
}

bool obeys(const Json& value, const Rule& rule, std::size_t index_limit) {
  switch (rule.kind) {
    case RuleKind::object:
      return value.is_object();
    case RuleKind::array:
      return value.is_array() && value.size() >= rule.length;
    case RuleKind::index:
      return value.is_number_unsigned() && value.get<std::uint64_t>() < index_limit;
    case RuleKind::integer:
      return value.is_number_integer() && is_in_range(value, rule);
    case RuleKind::number:
      return value.is_number() && is_in_range(value, rule);
    case RuleKind::positive:
      return value.is_number() && value.get<double>() > 0.0;
    case RuleKind::numbers:
      return is_numbers(value, rule.length);
    case RuleKind::boolean:
      return value.is_boolean();
    case RuleKind::text:
      return value.is_string();
    case RuleKind::word:
      return value.is_string() && is_one_of(value.get_ref<const std::string&>(), rule.of);
    case RuleKind::code:
      return value.is_number_unsigned() && is_one_of(std::to_string(value.get<std::uint64_t>()), rule.of);
  }
  return false;
}

std::string range_text(const Rule& rule) {
  if (std::isinf(rule.min) && std::isinf(rule.max)) return "";
  return fmt::format(" from {} to {}", rule.min, rule.max);
}

std::string expected_text(const Rule& rule, std::size_t index_limit) {
  switch (rule.kind) {
    case RuleKind::object:
      return "an object";
    case RuleKind::array:
      return rule.length == 0 ? "an array" : fmt::format("an array of at least {}", rule.length);
    case RuleKind::index:
      return fmt::format("an index into the {} {}", index_limit, rule.of);
    case RuleKind::integer:
      return "an integer" + range_text(rule);
    case RuleKind::number:
      return "a number" + range_text(rule);
    case RuleKind::positive:
      return "a number above 0";
    case RuleKind::numbers:
      return rule.length == 0 ? "an array of numbers" : fmt::format("an array of {} numbers", rule.length);
    case RuleKind::boolean:
      return "true or false";
    case RuleKind::text:
      return "a string";
    case RuleKind::word:
    case RuleKind::code:
      return fmt::format("one of {}", rule.of);
  }
  return "";
}

/// Checks one rule everywhere that its path leads to.
class RuleWalk {
 public:
  RuleWalk(const Json& document, const Rule& rule, const std::string& file) : rule_(rule), file_(file) {
    if (rule.kind != RuleKind::index) return;
    const Json* target = find_path(document, rule.of);
    if (target && target->is_array()) index_limit_ = target->size();
  }

  Result<void> walk(const Json& value, std::string_view path, const Place* place) const {
    if (path.empty()) return check(value, place);
    const auto slash = path.find('/');
    const auto key = path.substr(0, slash);
    const auto rest = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
    if (key == "*") return walk_all(value, rest, place);
    if (!value.is_object()) return {};
    const Place next{place, key, 0};
    const auto member = value.find(key);
    if (member != value.end()) return walk(*member, rest, &next);
    if (rule_.required && rest.empty()) return complain(&next, "nothing");
    return {};
  }

 private:
  Result<void> walk_all(const Json& value, std::string_view rest, const Place* place) const {
    if (value.is_array()) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        const Place next{place, {}, i};
        if (auto result = walk(value[i], rest, &next); !result) return result;
      }
    } else if (value.is_object()) {
      for (auto member = value.begin(); member != value.end(); ++member) {
        const Place next{place, member.key(), 0};
        if (auto result = walk(*member, rest, &next); !result) return result;
      }
    }
    return {};
  }

  Result<void> check(const Json& value, const Place* place) const {
    if (obeys(value, rule_, index_limit_)) return {};
    return complain(place, described(value));
  }

  Result<void> complain(const Place* place, const std::string& found) const {
    return import_error(file_, path_of(place), expected_text(rule_, index_limit_), found);
  }

  const Rule& rule_;
  const std::string& file_;
  std::size_t index_limit_ = 0;
};

}  // namespace

Result<void> check_rules(const Json& document, const std::string& file) {
  if (!document.is_object()) return import_error(file, "/", "a JSON object", described(document));
  for (const Rule& rule : gltf_rules()) {
    if (auto result = RuleWalk(document, rule, file).walk(document, rule.path, nullptr); !result)
      return result;
  }
  return {};
}

}  // namespace relume
