// SPDX-License-Identifier: MIT
//
// Which sender a ray has hit.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "precompute/atlas.h"
#include "precompute/charts.h"
#include "precompute/elements.h"
#include "precompute/geometry.h"
#include "precompute/ray_caster.h"

namespace relume {

/// A system's surface with its clusters.
struct ClusteredSurface {
  SystemSurface surface;
  std::vector<std::uint32_t> cluster;  ///< per element
  std::uint32_t cluster_count = 0;
  std::uint32_t first_cluster = 0;  ///< numbered through over all systems
};

/// Maps hits to clusters, numbered through over all systems. Most hits cost one look into the grid of lumels;
/// where a wall runs through or beside the lumel, the element is found that the hit point sees, so that no
/// light passes under a wall. Thread-safe.
class SenderLookup {
 public:
  /// Borrows everything; all must outlive it.
  SenderLookup(const Geometry& geometry, const std::vector<Chart>& charts,
               const std::vector<SystemLayout>& layouts, const std::vector<ClusteredSurface>& surfaces,
               const RayCaster& caster);

  /// The cluster hit, or kNone for surfaces that have none, and for points that no element of their
  /// neighbourhood sees.
  std::uint32_t sender(const SurfaceHit& hit) const;

 private:
  /// Lightmap coordinates over a triangle: base + u du + v dv.
  struct Mapping {
    glm::vec2 base{0.0f}, du{0.0f}, dv{0.0f};
    std::uint32_t system = kNone;
  };
  struct Grid {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint32_t> entry;  ///< cluster, kNone, or kSearch | cell to search from
  };
  void map_chart(const Chart& chart, const glm::uvec2& position, std::uint32_t system);
  std::uint32_t search(const SurfaceHit& hit, std::uint32_t system, std::uint32_t cell) const;

  const Geometry& geometry_;
  const std::vector<ClusteredSurface>& surfaces_;
  const RayCaster& caster_;
  std::vector<Mapping> front_, back_;
  std::vector<Grid> grids_;
};

}  // namespace relume
