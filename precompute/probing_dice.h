// SPDX-License-Identifier: MIT
//
// What the probing emissions (precompute/probing.h) are chosen by.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/mix.h"

namespace relume {

/// Numbers by chance, the same everywhere.
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint64_t a, std::uint64_t b) : state_(mix(mix(seed, a), b)) {}
  /// In [0, 1).
  float next() {
    state_ = mix(state_, 1);
    return float(state_ >> 40) / float(1 << 24);
  }

 private:
  std::uint64_t state_;
};

/// Of the lightings of a room: numbers in [0, 1) that fill three dimensions evenly (M. Roberts, The
/// Unreasonable Effectiveness of Quasirandom Sequences, 2018), so that its few beams end in different places.
struct Choices {
  float kind, place, target;

  Choices(std::uint64_t seed, std::uint32_t room, std::size_t probing) {
    Dice start(seed, 0x6b69 + room, 0);
    const auto next = [&](float step) {
      const float at = start.next() + step * float(probing);
      return at - std::floor(at);
    };
    kind = next(0.8191725f), place = next(0.6710436f), target = next(0.5497005f);
  }
};

}  // namespace relume
