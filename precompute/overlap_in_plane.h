// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace relume {

/// Whether two triangles lie in one plane, as far as single precision can tell, and share more of it than an
/// edge or a corner: rays meet both at equal distance. `largest` is the largest coordinate of the scene;
/// planes count as one within 2^-20 of it, and triangles as apart where they overlap by less than 2^-18 of
/// it. Answers yes for some that cross at less than a thousandth, too; never for degenerate triangles.
bool overlap_in_plane(const std::array<glm::vec3, 3>& a, const std::array<glm::vec3, 3>& b, float largest);

}  // namespace relume
