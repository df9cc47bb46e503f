// SPDX-License-Identifier: MIT
//
// A scene as Relume sees it: static surfaces in world space, their materials, punctual lights, cameras. Read
// from glTF 2.0 by load_scene (scene/load_scene.h).
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/light.h"
#include "core/model.h"
#include "core/quantities.h"

namespace relume {

enum class AlphaMode : std::uint32_t { opaque, mask, blend };

/// A decoded image: 8-bit RGBA, colours sRGB-coded as in the file.
struct SceneImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgba;
};

struct TextureUse {
  std::uint32_t image = kNone;
  std::uint32_t uv_set = 0;
  WrapMode wrap_s = WrapMode::repeat;
  WrapMode wrap_t = WrapMode::repeat;
  glm::dmat3 transform{1.0};  ///< KHR_texture_transform: uv' = transform * (u, v, 1)
};

struct SceneMaterial {
  std::string name;     ///< unique
  Rgb base_color{1.0};  ///< linear factor
  double alpha = 1.0;   ///< factor
  Rgb emission{0.0};    ///< radiance, cd/m2: emissive factor x strength
  std::optional<TextureUse> base_color_texture;
  std::optional<TextureUse> emission_texture;
  AlphaMode alpha_mode = AlphaMode::opaque;
  double alpha_cutoff = 0.5;
  double transmission = 0.0;  ///< 0..1: share of the light on its solid part that passes straight through
  bool double_sided = false;
  bool unlit = false;  ///< neither bounces nor emits
};

/// `extras.relume` of a node, inherited by its children unless they say otherwise. Absent = not said.
struct NodeExtras {
  std::optional<bool> is_static;
  /// "lightmap"; "clusters" and "probes": it reflects, but has no lumels; "none": it only blocks.
  std::optional<std::string> receiver;
  std::optional<std::string> system;
  std::optional<double> texel_size;      ///< m
  std::optional<std::uint32_t> quality;  ///< rays per lumel
  std::optional<std::uint32_t> budget;   ///< form factors kept per tile of its rows
  std::optional<bool> emitter;           ///< its materials may emit later
};

/// A node that carries surfaces, once per instance.
struct SceneNode {
  std::string path;  ///< unique: names from the root joined by '/', "#2" and so on for repeated ones
  NodeExtras extras;
  bool is_static = true;  ///< false: animated, skinned, or extras say so; its triangles are not in the scene
};

/// A run of triangles of one node and one material: one primitive of a glTF mesh.
struct SceneSurface {
  std::uint32_t node = 0;
  std::uint32_t material = 0;
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  bool has_uv0 = false;
  bool has_uv1 = false;
  bool has_colors = false;
};

/// Vertex attributes; arrays that a scene does not use are still as long as `positions`.
struct SceneVertices {
  std::vector<glm::dvec3> positions;  ///< world space, m
  std::vector<glm::vec2> uv0;
  std::vector<glm::vec2> uv1;
  std::vector<glm::vec4> colors;  ///< linear
};

/// Triangles of the file that are not in the scene.
struct DroppedTriangles {
  std::uint64_t without_area = 0;
  std::uint64_t repeated = 0;    ///< the same corners in the same sense as an earlier triangle
  std::uint64_t not_finite = 0;  ///< or beyond 1e18 m
  std::uint64_t dynamic = 0;     ///< of animated and skinned nodes, and of those that say so
};

struct Scene {
  std::string file_name;  ///< without its folder
  std::vector<SceneNode> nodes;
  std::vector<SceneMaterial> materials;
  std::vector<SceneImage> images;
  SceneVertices vertices;
  std::vector<std::array<std::uint32_t, 3>>
      triangles;  ///< of static nodes; counter-clockwise seen from the front, also under negative scales
  std::vector<SceneSurface> surfaces;  ///< cover `triangles` in order, without gaps
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  DroppedTriangles dropped;
  std::vector<std::string> warnings;  ///< one sentence each, without a final newline
};

}  // namespace relume
