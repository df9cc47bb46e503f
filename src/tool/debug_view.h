// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/model.h"
#include "core/result.h"
#include "tool/image.h"
#include "tool/json_value.h"

namespace relume {

/// Those below, and number_view_names().
const std::vector<std::string>& debug_view_names();

/// What each view shows, a line each, for people.
std::string debug_view_help();

struct DebugView {
  std::vector<ColorImage> images;  ///< one per system, display-linear, a texel per lumel
  std::string legend;              ///< a sentence: what the colours mean, and what was found
  JsonObject scale;                ///< the same in numbers
};

/// `view`: one of debug_view_names():
///   albedo     of the clusters, sRGB
///   clusters, materials, systems   a colour for each
///   validity   grey valid, red inside geometry, yellow split by a wall
/// and numbers (lumel_numbers.h): black, through red and yellow to white; blue where there is none.
/// `at`: world space, m; read by form_factors only. Fails as lumel_numbers() does.
Result<DebugView> draw_debug_view(const Model& model, const std::string& view, const glm::dvec3& at = {});

}  // namespace relume
