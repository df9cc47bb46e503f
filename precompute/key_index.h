// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/model.h"

namespace relume {

/// Finds keys by their value: these are as good as random, so their low bits say where to look.
class KeyIndex {
 public:
  KeyIndex() = default;
  /// Borrows the keys.
  explicit KeyIndex(std::span<const std::uint64_t> keys)
      : keys_(keys), next_(keys.size()), heads_(std::bit_ceil(keys.size() + 1), kNone) {
    for (auto i = std::uint32_t(keys.size()); i-- > 0;)
      next_[i] = std::exchange(heads_[keys[i] & (heads_.size() - 1)], i);
  }

  /// The first that has this value, or kNone.
  std::uint32_t find(std::uint64_t key) const {
    return heads_.empty() ? kNone : find_from(heads_[key & (heads_.size() - 1)], key);
  }
  /// The next one with the value of this, or kNone.
  std::uint32_t after(std::uint32_t place) const { return find_from(next_[place], keys_[place]); }

 private:
  std::uint32_t find_from(std::uint32_t place, std::uint64_t key) const {
    while (place != kNone && keys_[place] != key) place = next_[place];
    return place;
  }

  std::span<const std::uint64_t> keys_;
  std::vector<std::uint32_t> next_;   ///< per key: the next one whose low bits are the same, or kNone
  std::vector<std::uint32_t> heads_;  ///< per value of the low bits: the first key, or kNone
};

}  // namespace relume
