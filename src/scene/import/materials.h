// SPDX-License-Identifier: MIT
#pragma once

#include "core/result.h"
#include "scene/import/gltf_file.h"
#include "scene/load_scene.h"
#include "scene/scene.h"

namespace relume {

/// What a surface without a material reflects; glTF's own default of 1 would make a closed room gain light
/// for ever.
inline constexpr double kNoMaterialAlbedo = 0.5;

/// Fills Scene::materials (index = glTF index) and Scene::images. Appends warnings to the scene.
Result<void> convert_materials(const GltfFile& gltf, const SceneLimits& limits, Scene& scene);

/// Index of the material of surfaces that have none; made on first use.
std::uint32_t default_material(Scene& scene, std::uint32_t gltf_materials);

}  // namespace relume
