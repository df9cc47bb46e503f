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
#include "precompute/split_systems.h"
#include "scene/scene.h"

namespace relume {

/// Empty lumels around every chart, so that bilinear filtering and dilation stay inside it.
inline constexpr std::uint32_t kChartPadding = 1;

struct AtlasLayout {
  std::string name;
  std::vector<std::uint32_t> charts;    ///< indices, ascending
  std::vector<glm::uvec2> positions;    ///< of each chart's lower corner, lumels
  std::uint32_t width = 0, height = 0;  ///< lumels
};

/// Groups charts by extras.relume.system of their nodes, splits groups of too many lumels (split_systems.h),
/// packs each (stb_rect_pack). Parts of a named group are NAME#1, NAME#2, ...; those of the rest system0,
/// system1, ... A single chart may hold more than limits.lumels; `warnings` counts those. Fails (usage) when
/// one is too large for a lightmap, naming the node and the texel size that would do.
Result<std::vector<AtlasLayout>> lay_out_systems(const Scene& scene, const Geometry& geometry,
                                                 const std::vector<Chart>& charts, const RayCaster& caster,
                                                 const SystemLimits& limits,
                                                 std::vector<std::string>& warnings);

}  // namespace relume
