// SPDX-License-Identifier: MIT
#include "precompute/weighted_sums.h"

#include <gtest/gtest.h>

#include <vector>

namespace relume {
namespace {

/// Value k of sender s is 100 s + k: whole numbers, so that sums are exact in any order.
template <std::size_t kValues>
std::vector<std::array<float, kValues>> numbered(std::size_t senders) {
  std::vector<std::array<float, kValues>> values(senders);
  for (std::size_t s = 0; s < senders; ++s) {
    for (std::size_t k = 0; k < kValues; ++k) values[s][k] = float(100 * s + k);
  }
  return values;
}

template <std::size_t kValues>
void expect_sums_by_hand() {
  const auto values = numbered<kValues>(8);
  const std::vector<std::uint32_t> senders{1, 4, 7};
  const std::vector<float> factors{2.0f, 0.5f, 1.0f};
  std::array<float, kValues> sums;
  sums.fill(10.0f);
  add_weighted(senders, factors, std::span(values), sums);
  // 10 + 2 (100 + k) + 0.5 (400 + k) + (700 + k)
  for (std::size_t k = 0; k < kValues; ++k) EXPECT_EQ(sums[k], 1110.0f + 3.5f * float(k)) << k;
}

TEST(WeightedSums, OfThreeSendersAreThoseByHand) {
  expect_sums_by_hand<16>();
  expect_sums_by_hand<32>();
}

TEST(WeightedSums, OfNobodyAreLeftAsTheyWere) {
  std::array<float, 16> sums;
  sums.fill(3.0f);
  add_weighted({}, {}, std::span<const std::array<float, 16>>(), sums);
  for (const float sum : sums) EXPECT_EQ(sum, 3.0f);
}

}  // namespace
}  // namespace relume
