// SPDX-License-Identifier: MIT
//
// Which charts make up a system, and where each lies in the system's lightmap.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "core/result.h"
#include "precompute/charts.h"
#include "precompute/geometry.h"
#include "scene/scene.h"

namespace relume {

/// Empty lumels around every chart, so that bilinear filtering and dilation stay inside it.
inline constexpr std::uint32_t kChartPadding = 1;

/// Systems grow no larger than this: their lightmaps, rows and import tables stay within the limits of any
/// device.
inline constexpr std::uint64_t kMaxSystemCells = 1u << 18;

struct SystemLayout {
  std::string name;
  std::vector<std::uint32_t> charts;    ///< indices, ascending
  std::vector<glm::uvec2> positions;    ///< of each chart's lower corner, lumels
  std::uint32_t width = 0, height = 0;  ///< lumels
};

/// Groups charts by extras.relume.system of their nodes, halves groups of too many lumels in space along
/// their longest axis, packs each (stb_rect_pack). Fails (usage) when a single chart is too large, naming the
/// node and the texel size that would do.
Result<std::vector<SystemLayout>> lay_out_systems(const Scene& scene, const Geometry& geometry,
                                                  const std::vector<Chart>& charts);

}  // namespace relume
