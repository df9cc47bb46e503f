// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <unordered_map>

#include "scene/scene_opacity.h"
#include "scene/surface_color.h"

namespace relume {
namespace {

constexpr std::size_t kNodesNamed = 5;

/// XXH3 over values and strings, one after the other.
class Hasher {
 public:
  Hasher() { XXH3_64bits_reset(&state_); }
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    XXH3_64bits_update(&state_, &value, sizeof(T));
  }
  void add_text(const std::string& text) {
    add(std::uint64_t{text.size()});
    XXH3_64bits_update(&state_, text.data(), text.size());
  }
  std::uint64_t digest() const { return XXH3_64bits_digest(&state_); }

 private:
  XXH3_state_t state_;
};

void add_material(const SceneMaterial& material, Hasher& hasher) {
  hasher.add_text(material.name);
  hasher.add(static_cast<std::uint32_t>(material.double_sided));
  hasher.add(material.alpha_mode);
  if (material.alpha_mode != AlphaMode::opaque) {
    hasher.add(material.alpha);
    hasher.add(material.alpha_cutoff);
  }
  if (material.transmission > 0.0) hasher.add(material.transmission);
}

/// What textures and vertex colours cut out of the triangles of each node; of an image its alpha, not its
/// colours.
void add_opacities(const Scene& scene, std::vector<Hasher>& hashers) {
  const Opacity opacity = scene_opacity(scene);
  std::vector<std::uint64_t> maps;
  for (const OpacityMap& map : opacity.maps) {
    Hasher hasher;
    for (const std::uint32_t number : {map.width, std::uint32_t(map.wrap_s), std::uint32_t(map.wrap_t)})
      hasher.add(number);
    for (std::size_t i = 0; i < std::size_t{map.width} * map.height; ++i)
      hasher.add(opacity.texels[map.first_texel + i]);
    maps.push_back(hasher.digest());
  }
  const auto surfaces = surface_of_triangles(scene);
  for (const OpacityTriangle& listed : opacity.triangles) {
    Hasher& hasher = hashers[scene.surfaces[surfaces[listed.triangle]].node];
    hasher.add(listed.corners);
    hasher.add(maps[listed.map]);
  }
}

/// Positions count as float: exporters that write the same matrix in another way differ in the last bits of a
/// double.
void add_surface(const Scene& scene, const SceneSurface& surface, Hasher& hasher) {
  add_material(scene.materials[surface.material], hasher);
  hasher.add(surface.triangle_count);
  for (std::uint32_t t = 0; t < surface.triangle_count; ++t) {
    for (const std::uint32_t corner : scene.triangles[surface.first_triangle + t]) {
      hasher.add(glm::vec3(scene.vertices.positions[corner]) + 0.0f);
    }
  }
}

/// "a, b, c and 4 more", of at most kNodesNamed names.
std::string listed(const std::vector<std::string>& paths, const char* what) {
  if (paths.empty()) return "";
  const auto shown = paths.begin() + static_cast<std::ptrdiff_t>(std::min(paths.size(), kNodesNamed));
  std::string text = fmt::format("; {}: {}", what, fmt::join(paths.begin(), shown, ", "));
  if (paths.size() > kNodesNamed) text += fmt::format(" and {} more", paths.size() - kNodesNamed);
  return text;
}

}  // namespace

GeometryHash geometry_hash(const Scene& scene) {
  std::vector<Hasher> hashers(scene.nodes.size());
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    hashers[n].add(static_cast<std::uint32_t>(scene.nodes[n].is_static));
  }
  for (const SceneSurface& surface : scene.surfaces) add_surface(scene, surface, hashers[surface.node]);
  add_opacities(scene, hashers);
  GeometryHash out;
  Hasher total;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    out.nodes.push_back({scene.nodes[n].path, hashers[n].digest()});
    total.add_text(out.nodes.back().path);
    total.add(out.nodes.back().geometry_hash);
  }
  out.total = total.digest();
  return out;
}

std::string changed_nodes(const std::vector<NodeRecord>& before, const std::vector<NodeRecord>& now) {
  std::unordered_map<std::string, std::uint64_t> known;
  for (const NodeRecord& node : before) known.emplace(node.path, node.geometry_hash);
  std::vector<std::string> changed;
  std::vector<std::string> appeared;
  std::vector<std::string> gone;
  for (const NodeRecord& node : now) {
    const auto found = known.find(node.path);
    if (found == known.end()) {
      appeared.push_back(node.path);
      continue;
    }
    if (found->second != node.geometry_hash) changed.push_back(node.path);
    known.erase(found);
  }
  for (const NodeRecord& node : before) {
    if (known.count(node.path) != 0) gone.push_back(node.path);
  }
  return listed(changed, "moved or changed") + listed(appeared, "new") + listed(gone, "gone");
}

Result<void> check_same_geometry(const Model& model, const Scene& scene) {
  const GeometryHash now = geometry_hash(scene);
  if (now.total == model.geometry_hash) return {};
  std::string what = changed_nodes(model.nodes, now.nodes);
  if (what.empty()) what = "; the nodes stand in another order";
  return fail(ErrorCode::bad_input, fmt::format("{}: its geometry is not that of {}, which was precomputed{}",
                                                scene.file_name, model.provenance.scene_file, what));
}

}  // namespace relume
