// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/model.h"
#include "core/reference_solver.h"
#include "tool/image.h"

namespace relume {

/// albedo, clusters, materials, row_sum, systems, validity.
const std::vector<std::string>& debug_view_names();

/// One picture per system, display-linear, a texel per lumel, of `view` (one of debug_view_names()):
///   albedo     of the clusters, sRGB
///   clusters, materials, systems   a colour for each
///   row_sum    of the lumels' gather rows: black 0, through red and yellow to white 1
///   validity   grey valid, red inside geometry, yellow split by a wall
std::vector<ColorImage> draw_debug_view(const Model& model, const std::string& view);

}  // namespace relume
