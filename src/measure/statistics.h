// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <vector>

namespace relume {

/// 0 of none.
double median(std::vector<double> values);

/// Seconds that `work` takes.
template <class Work>
double seconds_of(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace relume
