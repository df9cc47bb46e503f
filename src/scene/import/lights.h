// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "scene/import/gltf_file.h"
#include "scene/import/node_walk.h"
#include "scene/scene.h"

namespace relume {

/// KHR_lights_punctual of the walked nodes, in world space: they shine along -Z of their node; scale does not
/// matter.
void convert_lights(const GltfFile& gltf, const std::vector<WalkedNode>& walk, Scene& scene);

/// Perspective cameras of the walked nodes.
void convert_cameras(const GltfFile& gltf, const std::vector<WalkedNode>& walk, Scene& scene);

}  // namespace relume
