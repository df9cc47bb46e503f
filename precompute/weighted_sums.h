// SPDX-License-Identifier: MIT
//
// Sparse rows times vectors of several values each: what the survey does most.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace relume {

/// sums[k] += factors[i] x values[senders[i]][k], one sender after the other; the same numbers on every
/// machine. As many factors as senders, each below the number of values.
void add_weighted(std::span<const std::uint32_t> senders, std::span<const float> factors,
                  std::span<const std::array<float, 16>> values, std::array<float, 16>& sums);
void add_weighted(std::span<const std::uint32_t> senders, std::span<const float> factors,
                  std::span<const std::array<float, 32>> values, std::array<float, 32>& sums);

}  // namespace relume
