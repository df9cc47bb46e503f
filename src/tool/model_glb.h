// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/model.h"
#include "core/result.h"
#include "tool/image.h"

namespace relume {

/// The model's geometry as a binary glTF for any viewer: one node per node of the scene, unlit, textured with
/// one picture per system through TEXCOORD_1. Both sides of double-sided surfaces are there, each with its
/// own part of the picture. World space, with Model::origin as the translation of the nodes.
Result<std::vector<std::byte>> encode_model_glb(const Model& model, const std::vector<ByteImage>& textures);

}  // namespace relume
