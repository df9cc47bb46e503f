// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/quantities.h"

namespace relume {

/// L U of three small dense matrices, one a channel, without pivoting: for 1 - C whose rows of C are not
/// negative and sum to less than 1. An unknown whose pivot is not above zero by more than rounding comes out
/// as zero.
class RgbLu {
 public:
  /// `matrix`: size x size, row by row.
  RgbLu(std::vector<Rgb> matrix, std::size_t size);

  /// The solution in place of the right side.
  void solve(std::vector<Rgb>& x) const;

 private:
  std::size_t size_;
  std::vector<Rgb> factors_;  ///< L below the diagonal, U above it, 1 / U or 0 on it
};

}  // namespace relume
