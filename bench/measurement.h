// SPDX-License-Identifier: MIT
//
// What a benchmark measured, and how it is printed.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "measure/statistics.h"

namespace relume::bench {

inline constexpr double kMilli = 1e3;

struct Measurement {
  std::string name;
  std::string unit;
  std::vector<double> values;  ///< one per repetition; a single one for facts
  std::string benchmark{};     ///< who runs it says which
};

/// Median, smallest and largest of each, aligned for a reader.
std::string as_table(std::span<const Measurement> measurements);

/// Header benchmark,name,unit,median,min,max,repetitions.
std::string as_csv(std::span<const Measurement> measurements);

/// {"measurements":[{"benchmark","name","unit","median","min","max","values"}]}
std::string as_json(std::span<const Measurement> measurements);

}  // namespace relume::bench
