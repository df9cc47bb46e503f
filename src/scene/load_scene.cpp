// SPDX-License-Identifier: MIT
#include "scene/load_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>

#include "scene/import/gltf_file.h"
#include "scene/import/images.h"
#include "scene/import/import_error.h"
#include "scene/import/lights.h"
#include "scene/import/materials.h"
#include "scene/import/node_walk.h"
#include "scene/import/primitives.h"
#include "scene/import/scene_folder.h"
#include "scene/import/triangles.h"
#include "scene/import/unique_names.h"

namespace relume {
namespace {

/// Turns a checked glTF file into a scene.
class SceneBuilder {
 public:
  SceneBuilder(GltfFile& gltf, const SceneLimits& limits)
      : gltf_(gltf), limits_(limits), meshes_(gltf.model.meshes.size()) {}

  Result<Scene> build() {
    scene_.file_name = gltf_.name;
    const auto walk = walk_nodes(gltf_);
    if (!walk) return tl::unexpected(walk.error());
    scene_.warnings = std::move(gltf_.warnings);
    if (auto result = convert_materials(gltf_, limits_, scene_); !result)
      return tl::unexpected(result.error());
    convert_lights(gltf_, *walk, scene_);
    convert_cameras(gltf_, *walk, scene_);
    for (std::size_t i = 0; i < walk->size(); ++i) {
      if (auto result = add_node(*walk, i); !result) return tl::unexpected(result.error());
    }
    drop_bad_triangles(scene_);
    report();
    return std::move(scene_);
  }

 private:
  Result<void> add_node(const std::vector<WalkedNode>& walk, std::size_t at) {
    const auto& node = gltf_.model.nodes[walk[at].node];
    if (node.mesh < 0) return {};
    const auto primitives = mesh(static_cast<std::size_t>(node.mesh));
    if (!primitives) return tl::unexpected(primitives.error());
    const auto instances = instance_transforms(gltf_, walk[at].node);
    if (!instances) return tl::unexpected(instances.error());
    const std::uint64_t triangles =
        count_triangles(gltf_.model, gltf_.model.meshes[static_cast<std::size_t>(node.mesh)]);
    if (triangles == 0) return {};
    const bool moves = node.skin >= 0 || (walk[at].is_animated && !walk[at].extras.is_static.value_or(false));
    const bool is_static = !moves && walk[at].extras.is_static.value_or(true);
    if (moves) ++moving_nodes_;
    if (moves) moving_triangles_ += triangles * instances->size();
    triangles_ += triangles * instances->size();
    if (triangles_ > limits_.max_triangles) {
      return import_error(gltf_.name, json_path("nodes", walk[at].node),
                          fmt::format("at most {} triangles in all", limits_.max_triangles),
                          fmt::format("{} so far", triangles_));
    }
    const std::string path = node_path(gltf_, walk, at);
    for (const auto& instance : *instances) {
      scene_.nodes.push_back({names_.unique(path), walk[at].extras, is_static});
      if (!is_static) {
        scene_.dropped.dynamic += triangles;
        continue;
      }
      for (const auto& primitive : **primitives) add_surface(primitive, walk[at].world * instance);
    }
    return {};
  }

  void add_surface(const MeshPrimitive& primitive, const glm::dmat4& world) {
    const auto gltf_materials = static_cast<std::uint32_t>(gltf_.model.materials.size());
    const std::uint32_t material = primitive.material >= 0 ? static_cast<std::uint32_t>(primitive.material)
                                                           : default_material(scene_, gltf_materials);
    append_surface(primitive, world, static_cast<std::uint32_t>(scene_.nodes.size() - 1), material, scene_);
    const auto lacks = [&](const std::optional<TextureUse>& use) {
      return use && (use->uv_set == 0 ? primitive.uv0.empty() : primitive.uv1.empty());
    };
    const SceneMaterial& used = scene_.materials[material];
    if (lacks(used.base_color_texture) || lacks(used.emission_texture)) ++surfaces_without_uv_;
  }

  /// Each mesh is read once, however many nodes show it.
  Result<const std::vector<MeshPrimitive>*> mesh(std::size_t index) {
    if (!meshes_[index]) {
      auto primitives = read_mesh(gltf_, index, counts_);
      if (!primitives) return tl::unexpected(primitives.error());
      meshes_[index] = std::move(*primitives);
    }
    return &*meshes_[index];
  }

  void warn(std::uint64_t count, const char* what) {
    if (count != 0) scene_.warnings.push_back(fmt::format("{}: {}: {}", gltf_.name, what, count));
  }

  void report() {
    warn(counts_.points_or_lines, "primitives of points or lines, skipped");
    warn(counts_.without_position, "primitives without POSITION, skipped");
    warn(counts_.with_morph_targets, "primitives with morph targets, of which only the base shape was read");
    warn(counts_.colors_clamped, "primitives with vertex colours outside 0 to 1, clamped");
    warn(surfaces_without_uv_, "surfaces with a texture but without its coordinates, taken as 0");
    const auto& dropped = scene_.dropped;
    if (moving_nodes_ != 0) {
      scene_.warnings.push_back(fmt::format(
          "{}: animated and skinned nodes do not bounce light and were left out: {} with {} triangles",
          gltf_.name, moving_nodes_, moving_triangles_));
    }
    if (dropped.without_area + dropped.repeated + dropped.not_finite != 0) {
      scene_.warnings.push_back(
          fmt::format("{}: dropped triangles: {} without area, {} repeated, {} not finite", gltf_.name,
                      dropped.without_area, dropped.repeated, dropped.not_finite));
    }
  }

  GltfFile& gltf_;
  const SceneLimits& limits_;
  Scene scene_;
  UniqueNames names_;
  std::vector<std::optional<std::vector<MeshPrimitive>>> meshes_;
  PrimitiveCounts counts_;
  std::uint64_t triangles_ = 0;
  std::uint64_t moving_nodes_ = 0;
  std::uint64_t moving_triangles_ = 0;
  std::uint64_t surfaces_without_uv_ = 0;
};

bool is_radiance(const glm::vec3& value) {
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(value[c]) || value[c] < 0.0f) return false;
  }
  return true;
}

}  // namespace

Result<Scene> load_scene(const std::filesystem::path& file, const SceneLimits& limits) {
  auto gltf = read_gltf(file, limits);
  if (!gltf) return tl::unexpected(gltf.error());
  try {
    return SceneBuilder(*gltf, limits).build();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, fmt::format("{}: no memory for its scene", file.string()));
  } catch (const std::exception& error) {
    return import_error(gltf->name, "/", "a readable scene", error.what());
  }
}

Result<EquirectangularSky> load_sky(const std::filesystem::path& file, const SceneLimits& limits) {
  const auto bytes = read_regular_file(file, limits.max_file_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::string name = file.filename().string();
  auto sky = decode_hdr(*bytes, limits.max_image_pixels, name);
  if (!sky) return sky;
  if (sky->width != 2 * sky->height) {
    return import_error(name, "size", "an equirectangular image, twice as wide as high",
                        fmt::format("{} x {}", sky->width, sky->height));
  }
  const auto bad = std::find_if_not(sky->radiance.begin(), sky->radiance.end(), is_radiance);
  if (bad != sky->radiance.end()) {
    const auto at = static_cast<std::size_t>(bad - sky->radiance.begin());
    return import_error(name, fmt::format("pixel {}, {}", at % sky->width, at / sky->width),
                        "finite radiance of at least 0", fmt::format("{} {} {}", bad->x, bad->y, bad->z));
  }
  return sky;
}

}  // namespace relume
