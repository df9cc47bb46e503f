// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/import/gltf_file.h"
#include "scene/scene.h"

namespace relume {

/// A node of the scene that is read, in depth-first order.
struct WalkedNode {
  std::size_t node = 0;           ///< index into the model's nodes
  std::size_t parent = SIZE_MAX;  ///< index into the walk
  glm::dmat4 world{1.0};          ///< affine
  NodeExtras extras;              ///< with what its ancestors say
  bool is_animated = false;       ///< a translation, rotation or scale of it or an ancestor moves
};

/// All nodes of the default scene, else of the first, else below every root. Appends warnings to the file.
Result<std::vector<WalkedNode>> walk_nodes(GltfFile& gltf);

/// Transforms under EXT_mesh_gpu_instancing, relative to the node; one identity when it has none.
Result<std::vector<glm::dmat4>> instance_transforms(const GltfFile& gltf, std::size_t node);

/// Names from the root joined by '/'; of very deep nodes only the last 32, behind "...". Not yet unique.
std::string node_path(const GltfFile& gltf, const std::vector<WalkedNode>& walk, std::size_t at);

}  // namespace relume
