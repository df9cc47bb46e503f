// SPDX-License-Identifier: MIT
#include "measurement.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace relume::bench {

std::string as_table(std::span<const Measurement> measurements) {
  std::string text = fmt::format("{:<22} {:<46} {:>12} {:>12} {:>12} {:>3}  {}\n", "benchmark", "name",
                                 "median", "min", "max", "n", "unit");
  for (const Measurement& m : measurements) {
    const auto [low, high] = std::minmax_element(m.values.begin(), m.values.end());
    text += fmt::format("{:<22} {:<46} {:>12.5g} {:>12.5g} {:>12.5g} {:>3}  {}\n", m.benchmark, m.name,
                        median(m.values), *low, *high, m.values.size(), m.unit);
  }
  return text;
}

std::string as_csv(std::span<const Measurement> measurements) {
  std::string text = "benchmark,name,unit,median,min,max,repetitions\n";
  for (const Measurement& m : measurements) {
    const auto [low, high] = std::minmax_element(m.values.begin(), m.values.end());
    text += fmt::format("{},{},{},{},{},{},{}\n", m.benchmark, m.name, m.unit, median(m.values), *low, *high,
                        m.values.size());
  }
  return text;
}

std::string as_json(std::span<const Measurement> measurements) {
  std::vector<std::string> objects;
  for (const Measurement& m : measurements) {
    const auto [low, high] = std::minmax_element(m.values.begin(), m.values.end());
    objects.push_back(fmt::format(
        R"({{"benchmark":"{}","name":"{}","unit":"{}","median":{},"min":{},"max":{},"values":[{}]}})",
        m.benchmark, m.name, m.unit, median(m.values), *low, *high, fmt::join(m.values, ",")));
  }
  return fmt::format("{{\"measurements\":[\n{}\n]}}\n", fmt::join(objects, ",\n"));
}

}  // namespace relume::bench
