// SPDX-License-Identifier: MIT
#pragma once

#include "core/opacity.h"
#include "scene/scene.h"

namespace relume {

/// What lets light through: alpha of materials with MASK and BLEND (factor x texture x vertex colour), and
/// transmission of all. Triangles that turn out to be solid everywhere are not listed, so that a texture
/// costs only where it is cut; those that turn out to be nowhere solid have alpha 0.
Opacity scene_opacity(const Scene& scene);

}  // namespace relume
