// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace relume {

/// A set of senders that is filled in any order and walked in ascending order.
class SenderSet {
 public:
  explicit SenderSet(std::size_t senders) : words_((senders + 63) / 64, 0) {}

  void insert(std::uint32_t sender) { words_[sender / 64] |= std::uint64_t{1} << (sender % 64); }

  /// insert() for a loop that calls it often, in which nothing else changes the set.
  auto inserter() {
    return [words = words_.data()](std::uint32_t sender) {
      words[sender / 64] |= std::uint64_t{1} << (sender % 64);
    };
  }

  std::size_t size() const;

  /// Calls visit(sender), ascending, and forgets all.
  template <class Visit>
  void drain(Visit&& visit) {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      for (std::uint64_t word = words_[w]; word != 0; word &= word - 1)
        visit(static_cast<std::uint32_t>(64 * w + static_cast<std::size_t>(std::countr_zero(word))));
      words_[w] = 0;
    }
  }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace relume
