// SPDX-License-Identifier: MIT
#include "compute/sender_ranges.h"

namespace relume {

std::optional<std::uint32_t> SenderRanges::take(std::uint32_t count) {
  if (count == 0) return 0;
  std::uint32_t gap = 0;
  for (const auto& [first, taken] : taken_) {
    if (first - gap >= count) break;
    gap = (first + taken + step_ - 1) / step_ * step_;
  }
  if (capacity_ - gap < count) return std::nullopt;
  taken_.emplace(gap, count);
  return gap;
}

}  // namespace relume
