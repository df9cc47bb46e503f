// SPDX-License-Identifier: MIT
#include "precompute/sender_set.h"

#include <span>

namespace relume {
namespace {

[[gnu::target_clones("popcnt", "default")]] std::size_t count_bits(std::span<const std::uint64_t> words) {
  std::size_t count = 0;
  for (const std::uint64_t word : words) count += static_cast<std::size_t>(std::popcount(word));
  return count;
}

}  // namespace

std::size_t SenderSet::size() const {
  return count_bits(words_);
}

}  // namespace relume
