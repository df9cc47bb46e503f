// SPDX-License-Identifier: MIT
//
// Small scenes as values, without a file: quads, boxes and meshes, one node and material each.
#pragma once

#include <array>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace relume::test {

/// Appends nodes to a Scene. Every add_ function makes one node of one material and returns the node's index.
class SceneBuilder {
 public:
  SceneBuilder() { scene_.file_name = "built"; }

  std::uint32_t material(const std::string& name, const Rgb& albedo, const Rgb& radiance = Rgb(0.0),
                         bool double_sided = false) {
    SceneMaterial m;
    m.name = name;
    m.base_color = albedo;
    m.emission = radiance;
    m.double_sided = double_sided;
    scene_.materials.push_back(m);
    return std::uint32_t(scene_.materials.size() - 1);
  }

  /// Corners counter-clockwise seen from the front.
  std::uint32_t add_quad(const std::string& node, std::uint32_t material_index,
                         const std::array<glm::dvec3, 4>& corners) {
    begin_node(node, material_index);
    quad(corners);
    return end_node();
  }

  /// Several quads as one node.
  std::uint32_t add_quads(const std::string& node, std::uint32_t material_index,
                          const std::vector<std::array<glm::dvec3, 4>>& quads) {
    begin_node(node, material_index);
    for (const auto& corners : quads) quad(corners);
    return end_node();
  }

  /// All six faces look outwards, or inwards (a room).
  enum class Facing { outward, inward };
  std::uint32_t add_box(const std::string& node, std::uint32_t material_index, const glm::dvec3& lower,
                        const glm::dvec3& upper, Facing facing) {
    begin_node(node, material_index);
    for (const auto& face : box_faces(lower, upper, facing)) quad(face);
    return end_node();
  }

  /// A box that stands on something: without its bottom.
  std::uint32_t add_standing_box(const std::string& node, std::uint32_t material_index,
                                 const glm::dvec3& lower, const glm::dvec3& upper) {
    begin_node(node, material_index);
    const auto faces = box_faces(lower, upper, Facing::outward);
    for (std::size_t f = 0; f < 6; ++f) {
      if (f != 2) quad(faces[f]);
    }
    return end_node();
  }

  /// Corners of `triangles` counter-clockwise seen from the front.
  std::uint32_t add_triangles(const std::string& node, std::uint32_t material_index,
                              const std::vector<glm::dvec3>& positions,
                              const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    begin_node(node, material_index);
    const auto first = std::uint32_t(scene_.vertices.positions.size());
    for (const auto& position : positions) vertex(position);
    for (const auto& t : triangles) scene_.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    return end_node();
  }

  /// The six faces as nodes of their own, named NODE/-x, +x, -y, +y, -z, +z.
  void add_room(const std::string& node, std::uint32_t material_index, const glm::dvec3& lower,
                const glm::dvec3& upper) {
    static constexpr std::array<const char*, 6> kNames{"-x", "+x", "-y", "+y", "-z", "+z"};
    const auto faces = box_faces(lower, upper, Facing::inward);
    for (std::size_t f = 0; f < 6; ++f) add_quad(node + "/" + kNames[f], material_index, faces[f]);
  }

  Scene& scene() { return scene_; }

 private:
  static std::array<std::array<glm::dvec3, 4>, 6> box_faces(const glm::dvec3& a, const glm::dvec3& b,
                                                            Facing facing) {
    using P = glm::dvec3;
    std::array<std::array<glm::dvec3, 4>, 6> faces{{
        {P(a.x, a.y, a.z), P(a.x, a.y, b.z), P(a.x, b.y, b.z), P(a.x, b.y, a.z)},
        {P(b.x, a.y, b.z), P(b.x, a.y, a.z), P(b.x, b.y, a.z), P(b.x, b.y, b.z)},
        {P(a.x, a.y, a.z), P(b.x, a.y, a.z), P(b.x, a.y, b.z), P(a.x, a.y, b.z)},
        {P(a.x, b.y, b.z), P(b.x, b.y, b.z), P(b.x, b.y, a.z), P(a.x, b.y, a.z)},
        {P(b.x, a.y, a.z), P(a.x, a.y, a.z), P(a.x, b.y, a.z), P(b.x, b.y, a.z)},
        {P(a.x, a.y, b.z), P(b.x, a.y, b.z), P(b.x, b.y, b.z), P(a.x, b.y, b.z)},
    }};
    if (facing == Facing::inward) {
      for (auto& face : faces) std::swap(face[1], face[3]);
    }
    return faces;
  }

  void begin_node(const std::string& node, std::uint32_t material_index) {
    SceneNode n;
    n.path = node;
    scene_.nodes.push_back(n);
    scene_.surfaces.push_back({std::uint32_t(scene_.nodes.size() - 1), material_index,
                               std::uint32_t(scene_.triangles.size()), 0, false, false, false});
  }

  void vertex(const glm::dvec3& position) {
    scene_.vertices.positions.push_back(position);
    scene_.vertices.uv0.emplace_back(0.0f);
    scene_.vertices.uv1.emplace_back(0.0f);
    scene_.vertices.colors.emplace_back(1.0f);
  }

  void quad(const std::array<glm::dvec3, 4>& corners) {
    const auto first = std::uint32_t(scene_.vertices.positions.size());
    for (const auto& corner : corners) vertex(corner);
    scene_.triangles.push_back({first, first + 1, first + 2});
    scene_.triangles.push_back({first, first + 2, first + 3});
  }

  std::uint32_t end_node() {
    scene_.surfaces.back().triangle_count =
        std::uint32_t(scene_.triangles.size()) - scene_.surfaces.back().first_triangle;
    return scene_.surfaces.back().node;
  }

  Scene scene_;
};

}  // namespace relume::test
