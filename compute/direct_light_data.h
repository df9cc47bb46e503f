// SPDX-License-Identifier: MIT
//
// What a model looks like in the buffers of direct light: plain numbers, no Vulkan objects.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "compute/light_schedule.h"
#include "core/model.h"
#include "kernels/shared/direct_light.h"

namespace relume {

/// The surfaces of some systems.
struct LightSurfaces {
  std::vector<kernels::LightPiece> pieces;
  std::vector<std::uint32_t> patches;
  std::vector<kernels::LightElement> elements;
  std::vector<LightBlock> blocks;
  std::vector<std::uint32_t> clusters;     ///< two per cluster: first element, number of elements
  std::vector<std::uint32_t> gather_rows;  ///< element
};

/// `systems` are loaded. `patches_per_element`: as DirectLightOptions.
LightSurfaces light_surfaces(const Model& model, const std::vector<std::uint32_t>& systems,
                             double patches_per_element);

/// The words of the tables; where clusters and gather rows begin is in the layout of LightTables.
struct LightTables {
  std::vector<std::uint32_t> words;
  std::uint32_t clusters = 0;
  std::uint32_t gather_rows = 0;
};
LightTables light_tables(const LightSurfaces& surfaces);

/// Triangles in leaf order: three corners each, and which of the opacity list it is.
std::vector<kernels::uvec4> leaf_triangles(const Occluders& occluders);

/// See opacity_at in kernels/include/shadow_ray.glsl.
std::vector<std::uint32_t> opacity_words(const Opacity& opacity);

/// `light` about the origin of the model.
kernels::LightRecord light_record(const Light& light);

}  // namespace relume
