// SPDX-License-Identifier: MIT
//
// Which charts make up a system when they are too many for one: cut in space, where little light crosses.
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/charts.h"
#include "precompute/geometry.h"
#include "precompute/ray_caster.h"

namespace relume {

/// How large systems grow, and what their rows are expected to cost.
struct SystemLimits {
  std::uint64_t lumels = std::uint64_t{1} << 16;  ///< of a system
  double cluster_size = 1.0;                      ///< m
  std::uint32_t row_entries = 512;                ///< a row keeps no more
};

/// What one chart asks of its system.
struct ChartCost {
  glm::vec3 lower{0.0f}, upper{0.0f};  ///< bounds
  std::uint64_t lumels = 0;            ///< about, never too few
  double cost = 1.0;                   ///< rows x expected entries of a row
};

/// Two charts that see each other.
struct ChartLink {
  std::uint32_t a = 0, b = 0;  ///< a < b
  double flux = 0.0;           ///< A_a F_ab + A_b F_ba, m2
};

/// No less than the lumels of a chart: those inside, and those that its outline runs through, if it is
/// convex.
std::uint64_t most_lumels_of(const Chart& chart);

/// Found with cosine-distributed rays from every chart: a share of 2^18 by its area, but at least 32.
/// Ascending by a, then b; the same for any number of threads and whatever else is in the scene.
std::vector<ChartLink> link_charts(const Geometry& geometry, const std::vector<Chart>& charts,
                                   const RayCaster& caster);

/// Entries of a row are the clusters of all charts that its chart sees.
std::vector<ChartCost> chart_costs(const Geometry& geometry, const std::vector<Chart>& charts,
                                   const std::vector<ChartLink>& links, const SystemLimits& limits);

/// Halves `group` (indices of charts) until no part has more than `most_lumels`; a chart that has as many is
/// a part of its own. A cut is a plane across one of nine directions, each side with a fifth of the cost at
/// least, where least flux crosses for the balance that it gives: so at walls and doors before the middle of
/// a room. A chart on both sides of the plane goes where it sees more. At the end parts below half of
/// `most_lumels` join those that they see best, where there is room. Ascending within each part.
std::vector<std::vector<std::uint32_t>> split_charts(const std::vector<ChartCost>& costs,
                                                     const std::vector<ChartLink>& links,
                                                     const std::vector<std::uint32_t>& group,
                                                     std::uint64_t most_lumels);

}  // namespace relume
