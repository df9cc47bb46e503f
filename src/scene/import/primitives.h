// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "core/result.h"
#include "scene/import/gltf_file.h"

namespace relume {

/// The triangles of one primitive in the space of its node, with only the vertices that they use. Those whose
/// height is lost in the precision of 32-bit coordinates have no area and are left out: the same mesh
/// quantized or stored otherwise keeps the same triangles.
struct MeshPrimitive {
  int material = -1;  ///< glTF index
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec2> uv0;  ///< as long as positions, or empty
  std::vector<glm::vec2> uv1;
  std::vector<glm::vec4> colors;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint64_t without_area = 0;  ///< triangles left out
};

/// What was seen on the way, for warnings.
struct PrimitiveCounts {
  std::uint64_t points_or_lines = 0;
  std::uint64_t without_position = 0;
  std::uint64_t with_morph_targets = 0;
  std::uint64_t colors_clamped = 0;
};

/// How many triangles a mesh will have, from counts alone.
std::uint64_t count_triangles(const tinygltf::Model& model, const tinygltf::Mesh& mesh);

/// All primitives of a mesh that have triangles.
Result<std::vector<MeshPrimitive>> read_mesh(const GltfFile& gltf, std::size_t mesh, PrimitiveCounts& counts);

}  // namespace relume
