// SPDX-License-Identifier: MIT
//
// Models of parallelograms without matrices, for what needs surfaces only.
#pragma once

#include <array>
#include <glm/geometric.hpp>
#include <vector>

#include "core/model.h"

namespace relume::test {

/// A parallelogram from `corner` along two edges; the front is where cross(edge_s, edge_t) points.
struct Quad {
  glm::dvec3 corner;
  glm::dvec3 edge_s;
  glm::dvec3 edge_t;
};

/// The six faces of a box, fronts inward (a room) or outward.
inline std::vector<Quad> box_quads(const glm::dvec3& lower, const glm::dvec3& upper, bool inward) {
  const glm::dvec3 size = upper - lower;
  const glm::dvec3 x(size.x, 0, 0);
  const glm::dvec3 y(0, size.y, 0);
  const glm::dvec3 z(0, 0, size.z);
  std::vector<Quad> quads{{lower, y, z},     {lower + x, z, y}, {lower, z, x},
                          {lower + y, x, z}, {lower, x, y},     {lower + z, y, x}};
  for (Quad& quad : quads) {
    if (!inward) std::swap(quad.edge_s, quad.edge_t);
  }
  return quads;
}

/// Appends a parallelogram to system 0 as one cluster of `cells` x `cells` elements, each with a lumel; or,
/// with cells = 0, as an occluder alone. World positions; the model stores them about its origin.
inline void add_quad(Model& model, const Quad& quad, std::uint32_t cells, Side side = Side::front) {
  if (model.systems.empty()) model.systems.emplace_back().name = "all";
  if (model.materials.empty()) model.materials.push_back({"paint", false, false});
  System& system = model.systems[0];
  const auto node = static_cast<std::uint32_t>(model.nodes.size());
  model.nodes.push_back({"quad" + std::to_string(node), 0});
  Occluders& occluders = model.occluders;
  const auto p = static_cast<std::uint32_t>(occluders.positions.size());
  const auto t = static_cast<std::uint32_t>(occluders.triangles.size());
  const glm::dvec3 from = quad.corner - model.origin;
  for (const glm::dvec3& at :
       {from, from + quad.edge_s, from + quad.edge_s + quad.edge_t, from + quad.edge_t}) {
    occluders.positions.emplace_back(at);
  }
  occluders.triangles.push_back({p, p + 1, p + 2});
  occluders.triangles.push_back({p, p + 2, p + 3});
  occluders.material.insert(occluders.material.end(), 2, 0u);
  occluders.node.insert(occluders.node.end(), 2, node);
  occluders.system.insert(occluders.system.end(), 2, cells > 0 ? 0u : kNone);
  occluders.front_uv.insert(occluders.front_uv.end(), 6, glm::vec2(0.0f));
  if (cells == 0) return;

  const glm::dvec3 cross = glm::cross(quad.edge_s, quad.edge_t);
  Cluster cluster;
  cluster.area = static_cast<float>(glm::length(cross));
  cluster.normal = glm::vec3(glm::normalize(cross)) * (side == Side::front ? 1.0f : -1.0f);
  cluster.centroid = glm::vec3(from + 0.5 * (quad.edge_s + quad.edge_t));
  cluster.node = node;
  cluster.side = side;
  cluster.first_element = static_cast<std::uint32_t>(system.elements.size());
  cluster.element_count = cells * cells;
  const auto cluster_index = static_cast<std::uint32_t>(system.clusters.size());
  system.clusters.push_back(cluster);

  // Of the first triangle, s = u + v and t = v; of the second, s = u and t = u + v.
  const auto corner = [](bool first, const glm::dvec2& st) {
    return first ? glm::vec2(st.x - st.y, st.y) : glm::vec2(st.x, st.y - st.x);
  };
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (std::uint32_t j = 0; j < cells; ++j) {
      const glm::dvec2 a = glm::dvec2(i, j) / static_cast<double>(cells);
      const glm::dvec2 b = glm::dvec2(i + 1, j + 1) / static_cast<double>(cells);
      const bool lower_first = i >= j;
      const bool upper_first = i > j;
      const auto piece = static_cast<std::uint32_t>(system.pieces.size());
      system.pieces.push_back(
          {lower_first ? t : t + 1,
           {corner(lower_first, a), corner(lower_first, {b.x, a.y}), corner(lower_first, b)}});
      system.pieces.push_back(
          {upper_first ? t : t + 1,
           {corner(upper_first, a), corner(upper_first, b), corner(upper_first, {a.x, b.y})}});
      const glm::dvec2 middle = 0.5 * (a + b);
      const auto element = static_cast<std::uint32_t>(system.elements.size());
      system.elements.push_back({glm::vec3(from + quad.edge_s * middle.x + quad.edge_t * middle.y),
                                 static_cast<float>(glm::length(cross) / (cells * cells)), cluster.normal,
                                 cluster_index, piece, 2});
      system.lumels.push_back({static_cast<std::uint16_t>(element % 4096),
                               static_cast<std::uint16_t>(element / 4096), element, 0});
    }
  }
}

/// Appends a sensor to system 0, which must be there.
inline void add_sensor(Model& model, const glm::dvec3& position, const glm::dvec3& normal) {
  const auto name = static_cast<std::uint32_t>(model.sensor_names.size());
  model.sensor_names.push_back("s" + std::to_string(name));
  model.systems[0].sensors.push_back({position, glm::vec3(normal), name});
}

}  // namespace relume::test
