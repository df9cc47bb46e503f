// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/model.h"
#include "scene/scene.h"

namespace relume {

/// Of the triangles whose material has a texture, or is a possible emitter (per material), those that have
/// the texture coordinates for it.
std::vector<TextureTriangle> texture_triangles(const Scene& scene,
                                               const std::vector<bool>& possible_emitters);

}  // namespace relume
