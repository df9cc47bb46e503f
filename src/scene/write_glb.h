// SPDX-License-Identifier: MIT
//
// A small writer of .glb from plain values. Indices between its parts are positions in the arrays of
// GlbScene.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/light.h"
#include "core/model.h"
#include "core/quantities.h"
#include "core/result.h"
#include "scene/scene.h"

namespace relume {

/// Triangles of one material. Attribute arrays other than `positions` are empty or as long as it.
struct GlbPrimitive {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> uv0;
  std::vector<glm::vec2> uv1;
  std::vector<glm::vec4> colors;  ///< linear
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::optional<std::uint32_t> material;
};

struct GlbMesh {
  std::string name;
  std::vector<GlbPrimitive> primitives;
};

struct GlbTexture {
  std::uint32_t image = 0;
  std::uint32_t uv_set = 0;
  WrapMode wrap = WrapMode::repeat;
};

struct GlbMaterial {
  std::string name;
  Rgb base_color{1.0};  ///< linear, 0 to 1
  Rgb emission{0.0};    ///< radiance, cd/m2; above 1 it is written with KHR_materials_emissive_strength
  std::optional<GlbTexture> base_color_texture;
  std::optional<GlbTexture> emission_texture;
  bool double_sided = false;
  bool unlit = false;
};

struct GlbCamera {
  double vertical_field_of_view = 1.0;  ///< radians
};

/// A node of the one scene of the file. `light` is punctual and shines along -Z; its position and direction
/// are not read.
struct GlbNode {
  std::string name;
  glm::dmat4 transform{1.0};  ///< relative to the parent, affine
  std::optional<std::uint32_t> parent;
  std::optional<std::uint32_t> mesh;
  std::optional<std::uint32_t> light;
  std::optional<std::uint32_t> camera;
  NodeExtras extras;
};

struct GlbScene {
  std::vector<std::vector<std::byte>> images;  ///< PNG files
  std::vector<GlbMaterial> materials;
  std::vector<GlbMesh> meshes;
  std::vector<Light> lights;
  std::vector<GlbCamera> cameras;
  std::vector<GlbNode> nodes;
};

/// Appends a light of world space, or a camera, with a node that places it.
void add_light(GlbScene& scene, const Light& light);
void add_camera(GlbScene& scene, const std::string& name, const Camera& camera);

/// The bytes of the file; the same scene gives the same bytes. Errors (usage): array lengths or indices that
/// do not fit, a file above 4 GiB.
Result<std::vector<std::byte>> encode_glb(const GlbScene& scene);

/// encode_glb, written through write_file: an existing file is replaced whole or not at all.
Result<void> write_glb(const GlbScene& scene, const std::filesystem::path& file);

}  // namespace relume
