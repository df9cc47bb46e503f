// SPDX-License-Identifier: MIT
#include "precompute/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "precompute/chart_sheets.h"

#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_rect_pack.h>
#pragma GCC diagnostic pop

namespace relume {
namespace {

constexpr std::uint32_t kMaxLightmapSize = 16384;

bool pack_into(std::vector<stbrp_rect>& rects, std::uint32_t width, std::uint32_t height) {
  std::vector<stbrp_node> nodes(width);
  stbrp_context context;
  stbrp_init_target(&context, int(width), int(height), nodes.data(), int(nodes.size()));
  return stbrp_pack_rects(&context, rects.data(), int(rects.size())) != 0;
}

Result<void> pack(const Scene& scene, const std::vector<Chart>& charts, AtlasLayout& layout) {
  std::vector<stbrp_rect> rects;
  std::uint64_t area = 0;
  std::uint32_t widest = 1;
  for (std::size_t i = 0; i < layout.charts.size(); ++i) {
    const Chart& chart = charts[layout.charts[i]];
    const std::uint32_t w = chart.width + 2 * kChartPadding, h = chart.height + 2 * kChartPadding;
    if (std::max(w, h) > kMaxLightmapSize) {
      return fail(ErrorCode::usage, fmt::format("{}: a chart of {} x {} lumels is larger than a lightmap "
                                                "({}); a texel size {:.2g} times as large would do",
                                                scene.nodes[chart.node].path, w, h, kMaxLightmapSize,
                                                double(std::max(w, h)) / kMaxLightmapSize));
    }
    widest = std::max(widest, w);
    area += std::uint64_t(w) * h;
    rects.push_back({int(i), int(w), int(h), 0, 0, 0});
  }
  layout.width = std::max(widest, static_cast<std::uint32_t>(std::ceil(std::sqrt(1.1 * double(area)))));
  layout.width = std::min((layout.width + 7) / 8 * 8, kMaxLightmapSize);
  layout.height = static_cast<std::uint32_t>(area / layout.width) + 1;
  while (!pack_into(rects, layout.width, layout.height)) {
    if (layout.height > kMaxLightmapSize) {
      return fail(
          ErrorCode::usage,
          fmt::format("system {}: {} lumels do not fit a lightmap of {} x {}; choose a larger texel size",
                      layout.name, area, kMaxLightmapSize, kMaxLightmapSize));
    }
    layout.height += std::max(1u, layout.height / 16);
  }
  layout.positions.resize(layout.charts.size());
  std::uint32_t used = 0;
  for (const stbrp_rect& rect : rects) {
    layout.positions[std::size_t(rect.id)] = {std::uint32_t(rect.x) + kChartPadding,
                                              std::uint32_t(rect.y) + kChartPadding};
    used = std::max(used, std::uint32_t(rect.y + rect.h));
  }
  layout.height = used;
  return {};
}

/// Charts of each name; those without one under "".
using NamedGroups = std::map<std::string, std::vector<std::uint32_t>>;

NamedGroups named_groups(const Scene& scene, const std::vector<Chart>& charts) {
  NamedGroups groups;
  for (std::uint32_t c = 0; c < charts.size(); ++c)
    groups[scene.nodes[charts[c].node].extras.system.value_or("")].push_back(c);
  return groups;
}

/// `groups`, each split where it is too large.
std::map<std::string, std::vector<std::vector<std::uint32_t>>> split_groups(const Geometry& geometry,
                                                                            const std::vector<Chart>& charts,
                                                                            const RayCaster& caster,
                                                                            const SystemLimits& limits,
                                                                            const NamedGroups& groups) {
  const auto lumels = [&](const std::vector<std::uint32_t>& group) {
    return std::accumulate(
        group.begin(), group.end(), std::uint64_t{0},
        [&](std::uint64_t sum, std::uint32_t c) { return sum + most_lumels_of(charts[c]); });
  };
  const bool fits = std::all_of(groups.begin(), groups.end(),
                                [&](const auto& group) { return lumels(group.second) <= limits.lumels; });
  const auto links = fits ? std::vector<ChartLink>{} : link_charts(geometry, charts, caster);
  const ChartSheets sheets(charts, geometry.triangles.size(), chart_costs(geometry, charts, links, limits),
                           links);
  std::map<std::string, std::vector<std::vector<std::uint32_t>>> parts;
  for (const auto& [name, group] : groups) parts[name] = sheets.split(group, limits.lumels);
  return parts;
}

/// Names of the parts of one group; unnamed ones skip names that the scene uses.
class SystemNames {
 public:
  explicit SystemNames(const NamedGroups& groups) : groups_(groups) {}
  std::string next(const std::string& group, std::size_t part, std::size_t parts) {
    if (!group.empty()) return parts > 1 ? fmt::format("{}#{}", group, part + 1) : group;
    std::string name;
    do {
      name = fmt::format("system{}", unnamed_++);
    } while (groups_.contains(name));
    return name;
  }

 private:
  const NamedGroups& groups_;
  std::uint32_t unnamed_ = 0;
};

void warn_of_large_charts(const std::vector<Chart>& charts, const SystemLimits& limits,
                          std::vector<std::string>& warnings) {
  const auto large = std::count_if(charts.begin(), charts.end(),
                                   [&](const Chart& chart) { return most_lumels_of(chart) > limits.lumels; });
  if (large == 0) return;
  warnings.push_back(
      fmt::format("{} chart(s) of more than {} lumels: each is a system of its own, larger than asked for",
                  large, limits.lumels));
}

}  // namespace

Result<std::vector<AtlasLayout>> lay_out_systems(const Scene& scene, const Geometry& geometry,
                                                 const std::vector<Chart>& charts, const RayCaster& caster,
                                                 const SystemLimits& limits,
                                                 std::vector<std::string>& warnings) {
  const NamedGroups groups = named_groups(scene, charts);
  warn_of_large_charts(charts, limits, warnings);
  SystemNames names(groups);
  std::vector<AtlasLayout> layouts;
  for (auto& [name, parts] : split_groups(geometry, charts, caster, limits, groups)) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      AtlasLayout layout;
      layout.name = names.next(name, p, parts.size());
      layout.charts = parts[p];
      if (auto packed = pack(scene, charts, layout); !packed) return tl::unexpected(packed.error());
      layouts.push_back(std::move(layout));
    }
  }
  return layouts;
}

}  // namespace relume
