// SPDX-License-Identifier: MIT
#include "tool/model_glb.h"

#include <glm/gtc/matrix_transform.hpp>
#include <map>

#include "scene/write_glb.h"
#include "tool/seen_point.h"

namespace relume {
namespace {

const Rgb kWithoutLightmap(0.02);

/// One primitive per node and system; triangles without a lightmap come as system kNone.
using PrimitiveKey = std::pair<std::uint32_t, std::uint32_t>;

class GlbBuilder {
 public:
  GlbBuilder(const Model& model, const std::vector<ByteImage>& textures)
      : model_(model), textures_(textures) {}

  Result<std::vector<std::byte>> build() {
    if (const Result<void> made = make_materials(); !made) return tl::unexpected(made.error());
    add_triangles();
    add_nodes();
    return encode_glb(glb_);
  }

 private:
  Result<void> make_materials() {
    for (std::size_t s = 0; s < textures_.size(); ++s) {
      GlbMaterial material;
      material.name = model_.systems[s].name;
      material.unlit = true;
      if (!textures_[s].pixels.empty()) {
        Result<std::vector<std::byte>> png = encode_png(textures_[s]);
        if (!png) return tl::unexpected(png.error());
        material.base_color_texture =
            GlbTexture{static_cast<std::uint32_t>(glb_.images.size()), 1, WrapMode::clamp_to_edge};
        glb_.images.push_back(std::move(*png));
      } else {
        material.base_color = kWithoutLightmap;
      }
      glb_.materials.push_back(std::move(material));
    }
    GlbMaterial blocker;
    blocker.name = "without lightmap";
    blocker.base_color = kWithoutLightmap;
    blocker.unlit = true;
    glb_.materials.push_back(std::move(blocker));
    return {};
  }

  void add_triangles() {
    const Occluders& occluders = model_.occluders;
    for (std::uint32_t t = 0; t < occluders.triangles.size(); ++t) {
      add_side(t, Side::front, occluders.front_uv);
      const bool double_sided = model_.materials[occluders.material[t]].double_sided;
      if (double_sided && !occluders.back_uv.empty()) add_side(t, Side::back, occluders.back_uv);
    }
  }

  void add_side(std::uint32_t triangle, Side side, const std::vector<glm::vec2>& uv) {
    const Occluders& occluders = model_.occluders;
    const std::uint32_t system = occluders.system[triangle];
    GlbPrimitive& primitive = primitives_[{occluders.node[triangle], system}];
    const glm::vec2 size = system == kNone ? glm::vec2(1.0f) : lightmap_size(model_.systems[system]);
    const auto first = static_cast<std::uint32_t>(primitive.positions.size());
    for (int k = 0; k < 3; ++k) {
      const glm::vec2 place = uv.empty() ? glm::vec2(0.0f) : uv[std::size_t{3} * triangle + k] / size;
      primitive.positions.push_back(occluder_corner(occluders, triangle, k));
      primitive.uv0.push_back(place);
      primitive.uv1.push_back(place);
    }
    const bool front = side == Side::front;
    primitive.triangles.push_back({first, first + (front ? 1 : 2), first + (front ? 2 : 1)});
    primitive.material = system == kNone ? static_cast<std::uint32_t>(textures_.size()) : system;
  }

  static glm::vec2 lightmap_size(const System& system) {
    return {std::max(system.lightmap_width, 1u), std::max(system.lightmap_height, 1u)};
  }

  void add_nodes() {
    for (auto& [key, primitive] : primitives_) {
      const std::uint32_t node = key.first;
      if (glb_.nodes.empty() || last_node_ != node) {
        last_node_ = node;
        GlbNode placed;
        placed.name = model_.nodes[node].path;
        placed.transform = glm::translate(glm::dmat4(1.0), model_.origin);
        placed.mesh = static_cast<std::uint32_t>(glb_.meshes.size());
        glb_.nodes.push_back(std::move(placed));
        glb_.meshes.push_back({model_.nodes[node].path, {}});
      }
      glb_.meshes.back().primitives.push_back(std::move(primitive));
    }
  }

  const Model& model_;
  const std::vector<ByteImage>& textures_;
  GlbScene glb_;
  std::map<PrimitiveKey, GlbPrimitive> primitives_;
  std::uint32_t last_node_ = 0;
};

}  // namespace

Result<std::vector<std::byte>> encode_model_glb(const Model& model, const std::vector<ByteImage>& textures) {
  return GlbBuilder(model, textures).build();
}

}  // namespace relume
