// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>

namespace relume {

/// Hands out names once: the second "a" becomes "a#2".
class UniqueNames {
 public:
  std::string unique(const std::string& name) {
    std::string candidate = name;
    while (!taken_.try_emplace(candidate, 1).second) candidate = name + "#" + std::to_string(++taken_[name]);
    return candidate;
  }

 private:
  std::unordered_map<std::string, std::uint64_t> taken_;
};

}  // namespace relume
