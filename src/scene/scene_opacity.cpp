// SPDX-License-Identifier: MIT
#include "scene/scene_opacity.h"

#include <map>
#include <set>

namespace relume {
namespace {

/// A triangle over more texels than this is judged by the whole image.
constexpr std::int64_t kMaxTexelsLookedAt = 4096;

/// Least and largest, 0..1.
struct Range {
  float least = 1.0f, most = 0.0f;
  void add(std::uint8_t texel) {
    least = std::min(least, float(texel) / 255.0f);
    most = std::max(most, float(texel) / 255.0f);
  }
};

class OpacityBuilder {
 public:
  explicit OpacityBuilder(const Scene& scene)
      : scene_(scene), map_of_material_(scene.materials.size(), kNone) {}

  Opacity build() {
    for (const SceneSurface& surface : scene_.surfaces) {
      const SceneMaterial& material = scene_.materials[surface.material];
      if (material.alpha_mode == AlphaMode::opaque && material.transmission <= 0.0) continue;
      for (std::uint32_t t = 0; t < surface.triangle_count; ++t)
        add_triangle(surface, material, surface.first_triangle + t);
    }
    return std::move(opacity_);
  }

 private:
  void add_triangle(const SceneSurface& surface, const SceneMaterial& material, std::uint32_t triangle) {
    OpacityTriangle listed{triangle, map_of(surface.material), {}};
    float least = 1.0f, most = 0.0f;
    for (std::size_t k = 0; k < 3; ++k) {
      listed.corners[k] = corner(surface, material, scene_.triangles[triangle][k]);
      least = std::min(least, listed.corners[k].z);
      most = std::max(most, listed.corners[k].z);
    }
    const OpacityMap& map = opacity_.maps[listed.map];
    const Range texels = map.width > 0 ? texels_under(listed) : Range{1.0f, 1.0f};
    if (opacity_of_alpha(map, least * texels.least) >= 1.0f) return;
    if (opacity_of_alpha(map, most * texels.most) <= 0.0f) {
      for (glm::vec3& at : listed.corners) at.z = 0.0f;
    }
    opacity_.triangles.push_back(listed);
  }

  glm::vec3 corner(const SceneSurface& surface, const SceneMaterial& material, std::uint32_t vertex) const {
    if (material.alpha_mode == AlphaMode::opaque) return {0.0f, 0.0f, 1.0f};
    const double of_vertex = surface.has_colors ? double(scene_.vertices.colors[vertex].w) : 1.0;
    const auto alpha = float(std::clamp(material.alpha * of_vertex, 0.0, 1.0));
    if (!material.base_color_texture) return {0.0f, 0.0f, alpha};
    const TextureUse& use = *material.base_color_texture;
    const glm::vec2& uv = (use.uv_set == 0 ? scene_.vertices.uv0 : scene_.vertices.uv1)[vertex];
    const glm::dvec3 at = use.transform * glm::dvec3(uv, 1.0);
    const auto bounded = [](double t) { return std::isfinite(t) ? float(std::clamp(t, -1e9, 1e9)) : 0.0f; };
    return {bounded(at.x), bounded(at.y), alpha};
  }

  std::uint32_t map_of(std::uint32_t index) {
    std::uint32_t& known = map_of_material_[index];
    if (known != kNone) return known;
    const SceneMaterial& material = scene_.materials[index];
    OpacityMap map;
    map.rule = material.alpha_mode == AlphaMode::mask ? OpacityRule::mask : OpacityRule::blend;
    map.cutoff = float(material.alpha_cutoff);
    map.solid = float(1.0 - material.transmission);
    if (material.alpha_mode != AlphaMode::opaque && material.base_color_texture)
      use_image(*material.base_color_texture, map);
    known = std::uint32_t(opacity_.maps.size());
    opacity_.maps.push_back(map);
    whole_.push_back({});
    for (std::uint64_t i = 0; i < std::uint64_t{map.width} * map.height; ++i)
      whole_.back().add(opacity_.texels[map.first_texel + i]);
    return known;
  }

  void use_image(const TextureUse& use, OpacityMap& map) {
    const SceneImage& image = scene_.images[use.image];
    map.width = image.width;
    map.height = image.height;
    map.wrap_s = use.wrap_s;
    map.wrap_t = use.wrap_t;
    const auto [found, is_new] = first_texel_.emplace(use.image, std::uint32_t(opacity_.texels.size()));
    map.first_texel = found->second;
    if (!is_new) return;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) opacity_.texels.push_back(image.rgba[i]);
  }

  /// Texels [first, last] along one axis that the triangle may meet, one more on each side for rounding; all
  /// when they go round.
  static std::pair<std::int64_t, std::int64_t> reach(const OpacityTriangle& listed, int axis,
                                                     std::uint32_t size) {
    const auto& c = listed.corners;
    const double lower = std::min({c[0][axis], c[1][axis], c[2][axis]}),
                 upper = std::max({c[0][axis], c[1][axis], c[2][axis]});
    const auto first = std::int64_t(std::floor(lower * size)) - 1,
               last = std::int64_t(std::floor(upper * size)) + 1;
    if (last - first + 1 >= std::int64_t{size}) return {0, std::int64_t{size} - 1};
    return {first, last};
  }

  Range texels_under(const OpacityTriangle& listed) const {
    const OpacityMap& map = opacity_.maps[listed.map];
    const auto [left, right] = reach(listed, 0, map.width);
    const auto [top, bottom] = reach(listed, 1, map.height);
    if ((right - left + 1) * (bottom - top + 1) > kMaxTexelsLookedAt) return whole_[listed.map];
    Range range;
    for (std::int64_t y = top; y <= bottom; ++y) {
      const std::size_t row = wrapped_texel((double(y) + 0.5) / map.height, map.wrap_t, map.height);
      for (std::int64_t x = left; x <= right; ++x) {
        const std::size_t column = wrapped_texel((double(x) + 0.5) / map.width, map.wrap_s, map.width);
        range.add(opacity_.texels[map.first_texel + row * map.width + column]);
      }
    }
    return range;
  }

  const Scene& scene_;
  Opacity opacity_;
  std::vector<std::uint32_t> map_of_material_;
  std::vector<Range> whole_;                            ///< per map: over its whole image
  std::map<std::uint32_t, std::uint32_t> first_texel_;  ///< per image of the scene
};

/// Leaves out maps and texels that no triangle uses.
Opacity without_unused(Opacity opacity) {
  std::vector<std::uint32_t> number(opacity.maps.size(), kNone);
  std::map<std::uint32_t, std::uint32_t> moved;  ///< first texel: before, after
  Opacity kept;
  for (OpacityTriangle listed : opacity.triangles) {
    std::uint32_t& map = number[listed.map];
    if (map == kNone) {
      map = std::uint32_t(kept.maps.size());
      OpacityMap copy = opacity.maps[listed.map];
      if (copy.width > 0) {
        const auto [found, is_new] = moved.emplace(copy.first_texel, std::uint32_t(kept.texels.size()));
        const auto begin = opacity.texels.begin() + std::ptrdiff_t(copy.first_texel);
        const auto count = std::ptrdiff_t(copy.width) * std::ptrdiff_t(copy.height);
        if (is_new) kept.texels.insert(kept.texels.end(), begin, begin + count);
        copy.first_texel = found->second;
      }
      kept.maps.push_back(copy);
    }
    listed.map = map;
    kept.triangles.push_back(listed);
  }
  return kept;
}

}  // namespace

Opacity scene_opacity(const Scene& scene) {
  return without_unused(OpacityBuilder(scene).build());
}

}  // namespace relume
