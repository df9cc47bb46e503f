// SPDX-License-Identifier: MIT
#include "precompute/chart_sheets.h"

#include <algorithm>
#include <glm/common.hpp>
#include <map>
#include <utility>

#include "core/rooms.h"

namespace relume {
namespace {

std::vector<std::uint32_t> sheets_of(const std::vector<Chart>& charts, std::size_t triangles) {
  JoinedSets sheets(charts.size());
  std::vector<std::uint32_t> first(triangles, kNone);
  for (std::uint32_t c = 0; c < charts.size(); ++c) {
    for (const std::uint32_t triangle : charts[c].triangles) {
      if (first[triangle] == kNone) first[triangle] = c;
      sheets.join(first[triangle], c);
    }
  }
  return sheets.all();
}

/// The cost of a sheet in place of that of its lowest chart.
std::vector<ChartCost> costs_of_sheets(std::vector<ChartCost> costs,
                                       const std::vector<std::uint32_t>& sheets) {
  for (std::uint32_t c = 0; c < sheets.size(); ++c) {
    if (sheets[c] == c) continue;
    ChartCost& sheet = costs[sheets[c]];
    sheet.lower = glm::min(sheet.lower, costs[c].lower), sheet.upper = glm::max(sheet.upper, costs[c].upper);
    sheet.lumels += costs[c].lumels, sheet.cost += costs[c].cost;
  }
  return costs;
}

std::vector<ChartLink> links_of_sheets(const std::vector<ChartLink>& links,
                                       const std::vector<std::uint32_t>& sheets) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> flux;
  for (const ChartLink& link : links) {
    const auto [a, b] = std::minmax(sheets[link.a], sheets[link.b]);
    if (a != b) flux[{a, b}] += link.flux;
  }
  std::vector<ChartLink> joined;
  for (const auto& [pair, sum] : flux) joined.push_back({pair.first, pair.second, sum});
  return joined;
}

}  // namespace

ChartSheets::ChartSheets(const std::vector<Chart>& charts, std::size_t triangles,
                         std::vector<ChartCost> costs, const std::vector<ChartLink>& links)
    : sheets_(sheets_of(charts, triangles)),
      costs_(costs_of_sheets(std::move(costs), sheets_)),
      links_(links_of_sheets(links, sheets_)) {}

std::vector<std::vector<std::uint32_t>> ChartSheets::split(const std::vector<std::uint32_t>& group,
                                                           std::uint64_t most_lumels) const {
  std::vector<std::uint32_t> lowest;
  std::map<std::uint32_t, std::vector<std::uint32_t>> charts;
  for (const std::uint32_t c : group) {
    if (sheets_[c] == c) lowest.push_back(c);
    charts[sheets_[c]].push_back(c);
  }
  auto parts = split_charts(costs_, links_, lowest, most_lumels);
  for (auto& part : parts) {
    std::vector<std::uint32_t> all;
    for (const std::uint32_t sheet : part) all.insert(all.end(), charts[sheet].begin(), charts[sheet].end());
    std::sort(all.begin(), all.end());
    part = std::move(all);
  }
  return parts;
}

}  // namespace relume
