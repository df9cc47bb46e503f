// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/model.h"
#include "tool/image.h"

namespace relume {

/// albedo, clusters, cut, form_factors, materials, row_length, row_sum, systems, validity.
const std::vector<std::string>& debug_view_names();

/// One picture per system, display-linear, a texel per lumel, of `view` (one of debug_view_names()):
///   albedo     of the clusters, sRGB
///   clusters, materials, systems   a colour for each
///   row_sum    of the lumels' gather rows: black 0, through red and yellow to white 1
///   cut        likewise, how much of a row goes to means over several clusters
///   row_length likewise, how many senders a row names, relative to the longest
///   form_factors   likewise, the square root of the form factor per area from the valid lumel nearest to
///   `at`,
///                  relative to the largest; that lumel is green
///   validity   grey valid, red inside geometry, yellow split by a wall
/// `at`: world space, m; read by form_factors only.
std::vector<ColorImage> draw_debug_view(const Model& model, const std::string& view,
                                        const glm::dvec3& at = {});

}  // namespace relume
