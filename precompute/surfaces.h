// SPDX-License-Identifier: MIT
//
// The surfaces of a scene, cut into charts, lumels and clusters.
#pragma once

#include <vector>

#include "precompute/clusters.h"
#include "precompute/emitters.h"
#include "precompute/precompute.h"
#include "precompute/scene_change.h"

namespace relume {

struct Surfaces {
  const Geometry& geometry;  ///< borrowed
  std::vector<Chart> charts;
  std::vector<AtlasLayout> layouts;
  std::vector<ClusteredSurface> systems;
  std::vector<std::vector<bool>> own_elements;  ///< per system and element: whether it is a lumel's own
  std::vector<std::uint64_t> views;             ///< what was asked to cut them (views.h), where rows are kept

  std::uint32_t cluster_count() const { return systems.back().first_cluster + systems.back().cluster_count; }
};

/// What changed since an earlier precompute, and the keys of the triangles (geometry_keys.h).
struct EarlierSurfaces {
  const SceneChange& change;
  const std::vector<std::uint64_t>& triangle_keys;
};

/// Chooses the sizes that nobody asked for, and reports them.
void choose_sizes(const PrecomputeOptions& options, const Geometry& geometry, PrecomputeReport& report);

/// Takes the insides of solids (find_hollows.h) out of what receives light, reports how much they are, and
/// chooses sizes anew for what is left.
void leave_out_hollows(const Scene& scene, const PrecomputeOptions& options, const RayCaster& caster,
                       Geometry& geometry, PrecomputeReport& report);

/// Lumels and elements of charts of report.texel_size (charts.h); clusters come with cluster_surfaces. Fails
/// when nothing receives light. `earlier` may be missing; it saves rays, and changes nothing.
Result<Surfaces> cut_surfaces(const Scene& scene, const PrecomputeOptions& options, const RayCaster& caster,
                              const Geometry& geometry, std::vector<Chart> charts, PrecomputeReport& report,
                              const EarlierSurfaces* earlier = nullptr);

/// The same with sizes and charts that it chooses itself.
Result<Surfaces> cut_surfaces(const Scene& scene, const PrecomputeOptions& options, const RayCaster& caster,
                              const Geometry& geometry, PrecomputeReport& report);

/// Groups the elements of all systems anew: clusters of report.cluster_size, or with a `clearance_share` no
/// larger than that share of their clearance.
void cluster_surfaces(const Scene& scene, const RayCaster& caster, const PrecomputeReport& report,
                      double clearance_share, const std::vector<std::vector<float>>& clearances,
                      Surfaces& surfaces);

/// Clusters of materials that emit, and of nodes that say that they may.
Emitters possible_emitters(const Scene& scene, const Surfaces& surfaces);

}  // namespace relume
