// SPDX-License-Identifier: MIT
#include "tool/seen_point.h"

#include <glm/geometric.hpp>

namespace relume {

SeenPoint seen_point(const Model& model, std::uint32_t triangle, const glm::vec2& barycentric,
                     const glm::vec3& direction) {
  const glm::vec3& a = occluder_corner(model.occluders, triangle, 0);
  const glm::vec3 normal = glm::cross(occluder_corner(model.occluders, triangle, 1) - a,
                                      occluder_corner(model.occluders, triangle, 2) - a);
  return {triangle, glm::dot(normal, direction) < 0.0f ? Side::front : Side::back, barycentric};
}

bool hidden_back(const Model& model, const SeenPoint& point) {
  return point.side == Side::back && !model.materials[model.occluders.material[point.triangle]].double_sided;
}

std::optional<LightmapPlace> lightmap_place(const Model& model, const SeenPoint& point) {
  const Occluders& occluders = model.occluders;
  const std::uint32_t system = occluders.system[point.triangle];
  const std::vector<glm::vec2>& uv = point.side == Side::front ? occluders.front_uv : occluders.back_uv;
  if (system == kNone || hidden_back(model, point) || uv.empty()) return {};
  const glm::vec2* corners = &uv[std::size_t{3} * point.triangle];
  const glm::vec2& b = point.barycentric;
  return LightmapPlace{system, (1.0f - b.x - b.y) * corners[0] + b.x * corners[1] + b.y * corners[2]};
}

}  // namespace relume
