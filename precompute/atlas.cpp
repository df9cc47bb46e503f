// SPDX-License-Identifier: MIT
#include "precompute/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <map>

#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_rect_pack.h>
#pragma GCC diagnostic pop

namespace relume {
namespace {

constexpr std::uint32_t kMaxLightmapSize = 16384;

std::uint64_t cells(const Chart& chart) {
  return std::uint64_t(chart.width + 2 * kChartPadding) * (chart.height + 2 * kChartPadding);
}

glm::vec3 centre(const Geometry& geometry, const Chart& chart) {
  glm::vec3 lower = geometry.point(chart.triangles[0], 0.0f, 0.0f), upper = lower;
  for (const auto t : chart.triangles) {
    for (const auto corner : geometry.triangles[t]) {
      lower = glm::min(lower, geometry.positions[corner]);
      upper = glm::max(upper, geometry.positions[corner]);
    }
  }
  return 0.5f * (lower + upper);
}

/// Halves `group` until no part has more than kMaxSystemCells.
void split_in_space(const std::vector<Chart>& charts, const std::vector<glm::vec3>& centres,
                    std::vector<std::uint32_t> group, std::vector<std::vector<std::uint32_t>>& parts) {
  std::uint64_t total = 0;
  for (const auto c : group) total += cells(charts[c]);
  if (total <= kMaxSystemCells || group.size() < 2) {
    std::sort(group.begin(), group.end());
    parts.push_back(std::move(group));
    return;
  }
  glm::vec3 lower = centres[group[0]], upper = lower;
  for (const auto c : group) {
    lower = glm::min(lower, centres[c]);
    upper = glm::max(upper, centres[c]);
  }
  const glm::vec3 size = upper - lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  std::stable_sort(group.begin(), group.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return centres[a][axis] < centres[b][axis]; });
  std::uint64_t before = 0;
  std::size_t cut = 0;
  while (cut + 1 < group.size() && before < total / 2) before += cells(charts[group[cut++]]);
  split_in_space(charts, centres, {group.begin(), group.begin() + std::ptrdiff_t(cut)}, parts);
  split_in_space(charts, centres, {group.begin() + std::ptrdiff_t(cut), group.end()}, parts);
}

bool pack_into(std::vector<stbrp_rect>& rects, std::uint32_t width, std::uint32_t height) {
  std::vector<stbrp_node> nodes(width);
  stbrp_context context;
  stbrp_init_target(&context, int(width), int(height), nodes.data(), int(nodes.size()));
  return stbrp_pack_rects(&context, rects.data(), int(rects.size())) != 0;
}

Result<void> pack(const Scene& scene, const std::vector<Chart>& charts, SystemLayout& layout) {
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

}  // namespace

Result<std::vector<SystemLayout>> lay_out_systems(const Scene& scene, const Geometry& geometry,
                                                  const std::vector<Chart>& charts) {
  std::map<std::string, std::vector<std::uint32_t>> groups;
  std::vector<glm::vec3> centres;
  for (std::uint32_t c = 0; c < charts.size(); ++c) {
    groups[scene.nodes[charts[c].node].extras.system.value_or("")].push_back(c);
    centres.push_back(centre(geometry, charts[c]));
  }
  std::vector<SystemLayout> layouts;
  for (auto& [name, group] : groups) {
    std::vector<std::vector<std::uint32_t>> parts;
    split_in_space(charts, centres, std::move(group), parts);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      SystemLayout layout;
      layout.name = name.empty() ? fmt::format("system{}", layouts.size())
                                 : (parts.size() > 1 ? fmt::format("{}#{}", name, p + 1) : name);
      layout.charts = std::move(parts[p]);
      if (auto packed = pack(scene, charts, layout); !packed) return tl::unexpected(packed.error());
      layouts.push_back(std::move(layout));
    }
  }
  return layouts;
}

}  // namespace relume
