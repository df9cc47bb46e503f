// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace relume {

/// 64 well-mixed bits from two numbers (the finaliser of splitmix64: G. Steele et al., Fast Splittable
/// Pseudorandom Number Generators, 2014).
constexpr std::uint64_t mix(std::uint64_t a, std::uint64_t b = 0) {
  std::uint64_t x = a + 0x9e3779b97f4a7c15ull * (b + 1);
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

}  // namespace relume
