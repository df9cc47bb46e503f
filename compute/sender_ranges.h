// SPDX-License-Identifier: MIT
//
// Who has which part of a buffer that is shared: first fit, with gaps that merge; every part begins at a
// multiple of a step.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace relume {

class SenderRanges {
 public:
  /// `capacity`: a multiple of `step`.
  SenderRanges(std::uint32_t capacity, std::uint32_t step) : capacity_(capacity), step_(step) {}

  /// The first of `count` places in a row; nothing when no gap is large enough.
  std::optional<std::uint32_t> take(std::uint32_t count);

  /// Gives back what take() returned.
  void give_back(std::uint32_t first) { taken_.erase(first); }

 private:
  std::uint32_t capacity_;
  std::uint32_t step_;
  std::map<std::uint32_t, std::uint32_t> taken_;  ///< first: count, none empty
};

}  // namespace relume
