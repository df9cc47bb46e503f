// SPDX-License-Identifier: MIT
//
// What a surface reflects and emits, averaged over area; and how a model takes both from an edited copy of
// its scene.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "core/model.h"
#include "core/quantities.h"
#include "core/result.h"
#include "scene/scene.h"

namespace relume {

struct SurfaceColor {
  Rgb albedo{0.0};    ///< linear base colour x vertex colour, whatever `metallic` says; not clamped
  Rgb radiance{0.0};  ///< emitted, cd/m2
  double coverage =
      1.0;  ///< 0..1: how much of the part is solid (core/opacity.h); both colours are means over that
};

/// Area mean over the part of triangle `triangle` whose corners have the barycentric coordinates `corners`
/// (as SurfacePiece); sRGB is decoded before averaging. What alpha cuts out does not count, unless all is cut
/// out. Unlit materials give zero for both.
SurfaceColor mean_color(const Scene& scene, std::uint32_t triangle, const std::array<glm::vec2, 3>& corners);

/// Per triangle: index of its surface in Scene::surfaces.
std::vector<std::uint32_t> surface_of_triangles(const Scene& scene);

struct ClusterColors {
  std::vector<Rgb> albedo;              ///< per cluster of all systems, clamped to max_albedo
  std::vector<Rgb> exitance;            ///< lm/m2
  std::uint32_t clamped_materials = 0;  ///< materials with an albedo above max_albedo
};

/// Averages the materials of `scene` over the pieces of each cluster. The scene's triangles must be those of
/// the model (check_same_geometry).
ClusterColors cluster_colors(const Model& model, const Scene& scene, double max_albedo);

/// Hash of what a precompute depends on: positions after transform, material assignment, sidedness, alpha,
/// static or dynamic; not colours, not lights. Per node (in the order of Scene::nodes) and over all.
struct GeometryHash {
  std::vector<NodeRecord> nodes;
  std::uint64_t total = 0;
};
GeometryHash geometry_hash(const Scene& scene);

/// What is not as before: "; moved or changed: ...; new: ...; gone: ...", nodes named by their paths; empty
/// where they are the same in another order.
std::string changed_nodes(const std::vector<NodeRecord>& before, const std::vector<NodeRecord>& now);

/// Error (bad_input) with a sentence that names the nodes that moved, appeared or went, when the scene is not
/// the one of the model.
Result<void> check_same_geometry(const Model& model, const Scene& scene);

}  // namespace relume
