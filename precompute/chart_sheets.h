// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/charts.h"
#include "precompute/split_systems.h"

namespace relume {

/// Charts that share triangles, which are the two sides of a sheet: they go to one system, since a triangle
/// of the model has one.
class ChartSheets {
 public:
  /// `costs` per chart; `triangles`: how many the geometry has.
  ChartSheets(const std::vector<Chart>& charts, std::size_t triangles, std::vector<ChartCost> costs,
              const std::vector<ChartLink>& links);

  /// split_charts of whole sheets. A `group` holds all charts of a sheet or none.
  std::vector<std::vector<std::uint32_t>> split(const std::vector<std::uint32_t>& group,
                                                std::uint64_t most_lumels) const;

 private:
  std::vector<std::uint32_t> sheets_;  ///< per chart: the lowest of its sheet, which stands for all
  std::vector<ChartCost> costs_;
  std::vector<ChartLink> links_;
};

}  // namespace relume
