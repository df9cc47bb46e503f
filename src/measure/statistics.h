// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <span>
#include <vector>

#include "core/quantities.h"

namespace relume {

/// 0 of none.
double median(std::vector<double> values);

/// |a - b| / |b|, as vectors of all values; 0 where they are the same.
double relative_difference(std::span<const Rgb> a, std::span<const Rgb> b);

/// Seconds that `work` takes.
template <class Work>
double seconds_of(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace relume
