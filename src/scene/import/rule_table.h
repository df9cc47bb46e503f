// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string_view>

namespace relume {

enum class RuleKind { object, array, index, integer, number, positive, numbers, boolean, text, word, code };

/// What a property must be. In `path`, '*' stands for every element of an array or every member of an object.
struct Rule {
  std::string_view path;
  RuleKind kind;
  bool required = false;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::size_t length = 0;    ///< numbers: exact count, 0 = any; array: least count
  std::string_view of = "";  ///< index: the array it points into; word, code: those allowed, '|' between
};

/// glTF 2.0 and the extensions that are read. A container stands before what it holds, so a rule may rely on
/// those above it.
std::span<const Rule> gltf_rules();

}  // namespace relume
