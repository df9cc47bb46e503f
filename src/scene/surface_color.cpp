// SPDX-License-Identifier: MIT
#include "scene/surface_color.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <set>

#include "core/piece_samples.h"

namespace relume {
namespace {

const SceneSurface& surface_of(const Scene& scene, std::uint32_t triangle) {
  const auto after = std::upper_bound(
      scene.surfaces.begin(), scene.surfaces.end(), triangle,
      [](std::uint32_t t, const SceneSurface& surface) { return t < surface.first_triangle; });
  return *std::prev(after);
}

/// IEC 61966-2-1.
double linear_from_srgb(std::uint8_t code) {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double v = static_cast<double>(i) / 255.0;
      values[i] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    }
    return values;
  }();
  return table[code];
}

/// RGBA, as in the file.
const std::uint8_t* texel(const SceneImage& image, const TextureUse& use, const glm::dvec2& uv) {
  const glm::dvec3 at = use.transform * glm::dvec3(uv, 1.0);
  const std::size_t x = wrapped_texel(at.x, use.wrap_s, image.width);
  const std::size_t y = wrapped_texel(at.y, use.wrap_t, image.height);
  return &image.rgba[4 * (y * image.width + x)];
}

/// One triangle of a scene with all that its colour depends on.
struct ColoredTriangle {
  const Scene& scene;
  const SceneSurface& surface;
  const SceneMaterial& material;
  std::array<std::uint32_t, 3> vertices;

  template <glm::length_t L>
  glm::vec<L, double> interpolated(const std::vector<glm::vec<L, float>>& values, const glm::dvec2& b) const {
    using Value = glm::vec<L, double>;
    return (1.0 - b.x - b.y) * Value(values[vertices[0]]) + b.x * Value(values[vertices[1]]) +
           b.y * Value(values[vertices[2]]);
  }

  glm::dvec2 uv(const TextureUse& use, const glm::dvec2& b) const {
    return interpolated(use.uv_set == 0 ? scene.vertices.uv0 : scene.vertices.uv1, b);
  }

  Rgb texture(const std::optional<TextureUse>& use, const glm::dvec2& b) const {
    if (!use) return Rgb(1.0);
    const std::uint8_t* rgba = texel(scene.images[use->image], *use, uv(*use, b));
    return {linear_from_srgb(rgba[0]), linear_from_srgb(rgba[1]), linear_from_srgb(rgba[2])};
  }

  double opacity(const glm::dvec2& b) const {
    const double solid = 1.0 - material.transmission;
    if (material.alpha_mode == AlphaMode::opaque) return solid;
    double alpha = material.alpha * (surface.has_colors ? interpolated(scene.vertices.colors, b).w : 1.0);
    if (const auto& use = material.base_color_texture)
      alpha *= texel(scene.images[use->image], *use, uv(*use, b))[3] / 255.0;
    if (material.alpha_mode == AlphaMode::blend) return alpha * solid;
    return alpha >= material.alpha_cutoff ? solid : 0.0;
  }

  SurfaceColor at(const glm::dvec2& b) const {
    const Rgb vertex_color = surface.has_colors ? Rgb(interpolated(scene.vertices.colors, b)) : Rgb(1.0);
    return {material.base_color * vertex_color * texture(material.base_color_texture, b),
            material.emission * texture(material.emission_texture, b), opacity(b)};
  }

  /// How many texels a piece covers.
  double texels(const std::optional<TextureUse>& use, const PieceCorners& corners) const {
    if (!use) return 0.0;
    std::array<glm::dvec2, 3> p{};
    const SceneImage& image = scene.images[use->image];
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 at = use->transform * glm::dvec3(uv(*use, glm::dvec2(corners[i])), 1.0);
      p[i] = glm::dvec2(at) * glm::dvec2(image.width, image.height);
    }
    const glm::dvec2 a = p[1] - p[0];
    const glm::dvec2 b = p[2] - p[0];
    return std::abs(a.x * b.y - a.y * b.x) / 2.0;
  }
};

std::uint32_t sample_count(const ColoredTriangle& triangle, const PieceCorners& corners) {
  const double texels = std::max(triangle.texels(triangle.material.base_color_texture, corners),
                                 triangle.texels(triangle.material.emission_texture, corners));
  return piece_sample_count(texels);
}

struct ColorMean {
  SurfaceColor sum;
  double weight = 0.0;

  void add(const SurfaceColor& color, double more) {
    sum.albedo += more * color.albedo;
    sum.radiance += more * color.radiance;
    weight += more;
  }
  SurfaceColor mean() const {
    if (weight <= 0.0) return {};
    return {sum.albedo / weight, sum.radiance / weight};
  }
};

/// Mean over the solid area of all pieces of a cluster.
SurfaceColor cluster_color(const Model& model, const System& system, const Cluster& cluster,
                           const Scene& scene) {
  ColorMean mean;
  for (std::uint32_t e = 0; e < cluster.element_count; ++e) {
    const SurfaceElement& element = system.elements[cluster.first_element + e];
    for (std::uint32_t p = 0; p < element.piece_count; ++p) {
      const SurfacePiece& piece = system.pieces[element.first_piece + p];
      const double weight = triangle_area(model.occluders, piece.triangle) * piece_share(piece.corners);
      const SurfaceColor color = mean_color(scene, piece.triangle, piece.corners);
      mean.add(color, weight * std::max(color.coverage, 1e-12));
    }
  }
  return mean.mean();
}

std::uint32_t material_of(const Scene& scene, const System& system, const Cluster& cluster) {
  const SurfaceElement& element = system.elements[cluster.first_element];
  return surface_of(scene, system.pieces[element.first_piece].triangle).material;
}

}  // namespace

SurfaceColor mean_color(const Scene& scene, std::uint32_t triangle, const PieceCorners& corners) {
  const SceneSurface& surface = surface_of(scene, triangle);
  const SceneMaterial& material = scene.materials[surface.material];
  if (material.unlit) return {};
  const ColoredTriangle colored{scene, surface, material, scene.triangles[triangle]};
  if (!material.base_color_texture && !material.emission_texture) {
    const glm::vec2 centroid = (corners[0] + corners[1] + corners[2]) / 3.0f;
    return colored.at(glm::dvec2(centroid));
  }
  ColorMean solid, all;
  const std::uint32_t count = sample_count(colored, corners);
  for (std::uint32_t i = 0; i < count; ++i) {
    const SurfaceColor color = colored.at(piece_sample(i, corners));
    solid.add(color, color.coverage);
    all.add(color, 1.0);
  }
  SurfaceColor mean = solid.weight > 0.0 ? solid.mean() : all.mean();
  mean.coverage = solid.weight / static_cast<double>(count);
  return mean;
}

std::vector<std::uint32_t> surface_of_triangles(const Scene& scene) {
  std::vector<std::uint32_t> out(scene.triangles.size());
  for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
    const auto first = out.begin() + scene.surfaces[s].first_triangle;
    std::fill(first, first + scene.surfaces[s].triangle_count, s);
  }
  return out;
}

ClusterColors cluster_colors(const Model& model, const Scene& scene, double max_albedo) {
  ClusterColors out;
  std::set<std::uint32_t> clamped;
  for (const System& system : model.systems) {
    for (const Cluster& cluster : system.clusters) {
      const SurfaceColor color = cluster_color(model, system, cluster, scene);
      const Rgb albedo = glm::clamp(color.albedo, Rgb(0.0), Rgb(max_albedo));
      if (albedo != color.albedo) clamped.insert(material_of(scene, system, cluster));
      out.albedo.push_back(albedo);
      out.exitance.push_back(exitance_from_radiance(color.radiance));
    }
  }
  out.clamped_materials = static_cast<std::uint32_t>(clamped.size());
  return out;
}

}  // namespace relume
