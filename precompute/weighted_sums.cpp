// SPDX-License-Identifier: MIT
#include "precompute/weighted_sums.h"

#include <cstddef>
#include <cstring>

namespace relume {
namespace {

using Eight = float __attribute__((vector_size(32)));

/// Sums stay in registers; in arrays each would wait for the one before it to be stored.
template <std::size_t kValues>
[[gnu::always_inline]] inline void add_in_lanes(std::span<const std::uint32_t> senders,
                                                std::span<const float> factors,
                                                std::span<const std::array<float, kValues>> values,
                                                std::array<float, kValues>& sums) {
  constexpr std::size_t kEights = kValues / 8;
  std::array<Eight, kEights> own;
  std::memcpy(own.data(), sums.data(), sizeof sums);
  for (std::size_t i = 0; i < senders.size(); ++i) {
    const float* const of_sender = values[senders[i]].data();
    for (std::size_t k = 0; k < kEights; ++k) {
      Eight eight;
      std::memcpy(&eight, of_sender + 8 * k, sizeof eight);
      own[k] += factors[i] * eight;
    }
  }
  std::memcpy(sums.data(), own.data(), sizeof sums);
}

}  // namespace

[[gnu::target_clones("avx2", "default")]] void add_weighted(std::span<const std::uint32_t> senders,
                                                            std::span<const float> factors,
                                                            std::span<const std::array<float, 16>> values,
                                                            std::array<float, 16>& sums) {
  add_in_lanes(senders, factors, values, sums);
}

[[gnu::target_clones("avx2", "default")]] void add_weighted(std::span<const std::uint32_t> senders,
                                                            std::span<const float> factors,
                                                            std::span<const std::array<float, 32>> values,
                                                            std::array<float, 32>& sums) {
  add_in_lanes(senders, factors, values, sums);
}

}  // namespace relume
