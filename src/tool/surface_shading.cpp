// SPDX-License-Identifier: MIT
#include "tool/surface_shading.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/surface_color.h"
#include "tool/lightmap_image.h"

namespace relume {
namespace {

std::vector<std::uint32_t> lumel_grid(const System& system) {
  std::vector<std::uint32_t> grid(std::size_t{system.lightmap_width} * system.lightmap_height, kNone);
  for (std::uint32_t i = 0; i < system.lumels.size(); ++i) {
    grid[std::size_t{system.lumels[i].y} * system.lightmap_width + system.lumels[i].x] = i;
  }
  return grid;
}

bool is_valid(const Lumel& lumel) {
  return (lumel.flags & kLumelInvalid) == 0;
}

std::vector<Rgb> shown_irradiance(const System& system, std::span<const Rgb> irradiance) {
  const ColorImage image = lightmap_image(system, irradiance);
  std::vector<Rgb> shown;
  for (std::size_t i = 0; i < system.lumels.size(); ++i) {
    const Lumel& lumel = system.lumels[i];
    shown.push_back(is_valid(lumel) ? irradiance[i] : Rgb(image.at(lumel.x, lumel.y)));
  }
  return shown;
}

}  // namespace

struct SurfaceShading::Sum {
  const System& system;
  const SystemLumels& lumels;
  Rgb irradiance{0.0};
  Rgb albedo{0.0};
  Rgb exitance{0.0};
  double weight = 0.0;
};

SurfaceShading::SurfaceShading(const Model& model, const Lighting& lighting, std::span<const Rgb> irradiance,
                               FineColors colors)
    : model_(model), lighting_(lighting), colors_(std::move(colors)) {
  const std::vector<std::uint32_t> clusters = cluster_offsets(model);
  const std::vector<std::uint32_t> rows = gather_offsets(model);
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    const auto lumels = irradiance.subspan(rows[s], system.lumels.size());
    systems_.push_back({lumel_grid(system), shown_irradiance(system, lumels), clusters[s]});
  }
}

Rgb SurfaceShading::radiance(const SeenPoint& point) const {
  const std::optional<LightmapPlace> place = lightmap_place(model_, point);
  if (!place) return Rgb(0.0);
  Sum sum{model_.systems[place->system], systems_[place->system]};
  add_lumels(point, place->texel, 1, Use::valid, sum);
  for (int reach = 1; reach <= 4 && sum.weight <= 0.0; ++reach)
    add_lumels(point, place->texel, reach, Use::all, sum);
  return sum.weight > 0.0 ? radiance_of(point, sum) : Rgb(0.0);
}

Rgb SurfaceShading::radiance_of(const SeenPoint& point, const Sum& sum) const {
  const Rgb irradiance = sum.irradiance / sum.weight;
  const std::uint32_t material = model_.occluders.material[point.triangle];
  const bool replaced =
      std::find(colors_.replaced.begin(), colors_.replaced.end(), material) != colors_.replaced.end();
  if (!colors_.scene || replaced) {
    return radiance_from_radiosity(sum.exitance / sum.weight + sum.albedo / sum.weight * irradiance);
  }
  const glm::vec2& b = point.barycentric;
  const SurfaceColor color = mean_color(*colors_.scene, point.triangle, {b, b, b});
  return color.radiance +
         radiance_from_radiosity(glm::min(color.albedo, Rgb(colors_.max_albedo)) * irradiance);
}

void SurfaceShading::add_lumels(const SeenPoint& point, const glm::vec2& texel, int reach, Use use,
                                Sum& sum) const {
  const int width = static_cast<int>(sum.system.lightmap_width);
  const int height = static_cast<int>(sum.system.lightmap_height);
  const glm::vec2 place = texel - glm::vec2(0.5f);
  const int x0 = static_cast<int>(std::floor(place.x)) - (reach - 1);
  const int y0 = static_cast<int>(std::floor(place.y)) - (reach - 1);
  for (int y = std::max(y0, 0); y < std::min(y0 + 2 * reach, height); ++y) {
    for (int x = std::max(x0, 0); x < std::min(x0 + 2 * reach, width); ++x) {
      const std::uint32_t lumel = sum.lumels.lumel_at[std::size_t(y) * width + x];
      const float wx = 1.0f - std::abs(place.x - float(x)) / float(reach);
      const float wy = 1.0f - std::abs(place.y - float(y)) / float(reach);
      if (lumel == kNone || wx * wy <= 0.0f) continue;
      if (use == Use::all || is_valid(sum.system.lumels[lumel])) add_lumel(point, lumel, wx * wy, sum);
    }
  }
}

/// Texels side by side may belong to different charts: those of another node, material, side or direction do
/// not count.
void SurfaceShading::add_lumel(const SeenPoint& point, std::uint32_t lumel, float weight, Sum& sum) const {
  const Occluders& occluders = model_.occluders;
  const SurfaceElement& element = sum.system.elements[sum.system.lumels[lumel].element];
  const Cluster& cluster = sum.system.clusters[element.cluster];
  if (cluster.node != occluders.node[point.triangle] ||
      cluster.material != occluders.material[point.triangle] || cluster.side != point.side) {
    return;
  }
  const glm::vec3& a = occluder_corner(occluders, point.triangle, 0);
  const glm::vec3 normal = glm::cross(occluder_corner(occluders, point.triangle, 1) - a,
                                      occluder_corner(occluders, point.triangle, 2) - a);
  const float facing = glm::dot(normal, element.normal) * (point.side == Side::front ? 1.0f : -1.0f);
  if (facing < 0.5f * glm::length(normal)) return;
  const std::size_t i = sum.lumels.first_cluster + element.cluster;
  sum.irradiance += double(weight) * sum.lumels.irradiance[lumel];
  sum.albedo += double(weight) * lighting_.albedo[i];
  sum.exitance += double(weight) * lighting_.exitance[i];
  sum.weight += weight;
}

}  // namespace relume
