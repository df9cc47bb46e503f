// SPDX-License-Identifier: MIT
//
// Which sender a ray has hit.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "precompute/atlas.h"
#include "precompute/charts.h"
#include "precompute/elements.h"
#include "precompute/geometry.h"
#include "precompute/mutual_visibility.h"
#include "precompute/ray_caster.h"

namespace relume {

/// A system's surface with its clusters.
struct ClusteredSurface {
  SystemSurface surface;
  std::vector<std::uint32_t> cluster;  ///< per element
  std::uint32_t cluster_count = 0;
  std::uint32_t first_cluster = 0;     ///< numbered through over all systems
  std::vector<std::uint32_t> senders;  ///< per cluster: its number among all senders

  std::uint32_t sender_of(std::uint32_t element) const { return senders[cluster[element]]; }
};

/// The sender that an element belongs to, and whether surfaces cross or touch near the element, as far as its
/// lumel shows it: one word, for rays ask for both.
class ElementOwner {
 public:
  ElementOwner() = default;
  ElementOwner(std::uint32_t sender, bool near_walls) : word_(sender | (near_walls ? kNearWalls : 0u)) {}
  std::uint32_t sender() const { return word_ & ~kNearWalls; }
  bool near_walls() const { return (word_ & kNearWalls) != 0; }

 private:
  static constexpr std::uint32_t kNearWalls = 0x80000000u;
  std::uint32_t word_ = 0;
};

/// Maps hits to elements, numbered through over all systems, and these to senders. Most hits cost one look
/// into the grid of lumels, or into one four times as fine where a wall runs through or beside the lumel;
/// where a wall cuts a cell of that too, the element is found that the hit point sees, so that no light
/// passes under a wall. The same place of the same chart gives the same element, wherever the chart lies in
/// its lightmap. Thread-safe.
class SenderLookup {
 public:
  /// Borrows everything; all must outlive it. Clusters may be made, or made anew, later: follow_clusters().
  SenderLookup(const Geometry& geometry, const std::vector<Chart>& charts,
               const std::vector<AtlasLayout>& layouts, const std::vector<ClusteredSurface>& surfaces,
               const RayCaster& caster);

  /// The element hit, or kNone for surfaces that have none, and for points that no element of their
  /// neighbourhood sees.
  std::uint32_t element(const SurfaceHit& hit) const;

  /// The surfaces have new clusters, or these new numbers.
  void follow_clusters();

  ElementOwner owner_of(std::uint32_t element) const { return owners_[element]; }
  /// The sender that an element belongs to.
  std::uint32_t sender_of(std::uint32_t element) const { return owners_[element].sender(); }
  /// Of a system, among the elements of all.
  std::uint32_t first_element(std::size_t system) const { return first_elements_[system]; }
  std::uint32_t element_count() const { return std::uint32_t(owners_.size()); }
  /// Whether all hits on the lumel of an element are on it, without a look at the surfaces around.
  bool simple(std::size_t system, std::uint32_t element_of_system) const {
    return (grids_[system].entry[surfaces_[system].surface.elements[element_of_system].cell] & kSearch) == 0;
  }

  /// Instead of an element: the back of a single-sided surface, opaque and black.
  static constexpr std::uint32_t kBlackBack = kNone - 1;

  /// The element that a ray travelling along `direction` sees where it met a triangle (seen_surface), or
  /// kNone, or kBlackBack.
  std::uint32_t seen(std::uint32_t triangle, float u, float v, const glm::vec3& direction) const {
    const Face& face = front_[triangle];
    const bool from_front = glm::dot(face.normal, direction) < 0.0f;
    return from_front ? element_on(face, {triangle, u, v, Side::front})
                      : seen_from_behind(triangle, u, v, direction);
  }

  /// The same of all lanes of a packet at once; bits of those whose `places` are known. The others are to be
  /// asked one by one: they met nothing, or a back, or are near walls.
  std::uint32_t seen(const RayPacket& rays, std::array<std::uint32_t, kPacketSize>& places) const;

 private:
  /// All that a hit asks of one side of a triangle. Coordinates over it in the chart: base + u du + v dv,
  /// lumels.
  struct Face {
    glm::vec3 normal{0.0f};  ///< of the front
    glm::vec2 base{0.0f}, du{0.0f}, dv{0.0f};
    std::uint32_t system = kNone;
    std::uint16_t x = 0, y = 0;  ///< of the chart in the lightmap
  };
  static constexpr std::uint32_t kSearch = 0x80000000u;
  static constexpr std::uint32_t kNoFineCell = kSearch - 2;  ///< kSearch | kNoFineCell is not kNone
  /// One entry per sub-cell (kSubcells^2) of a cell: its element, or kSearch; kNone until somebody asks.
  /// Others who ask meanwhile find the same.
  using FineCell = std::array<std::atomic<std::uint32_t>, kSubcells * kSubcells>;
  struct Grid {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint32_t> entry;  ///< element, kNone, or kSearch | index into `fine` or kNoFineCell
    mutable std::vector<FineCell> fine;
    std::vector<std::uint32_t> fine_cells;  ///< per entry of `fine`: its cell
  };
  struct GridPoint {
    std::uint32_t x, y;
    float in_x, in_y;  ///< within the cell, in [0, 1]
  };
  void map_chart(const Chart& chart, const glm::uvec2& position, std::uint32_t system);
  static GridPoint locate(const Face& face, const Grid& grid, float u, float v) {
    const glm::vec2 at = face.base + face.du * u + face.dv * v;
    const auto x = std::uint32_t(std::max(at.x, 0.0f)), y = std::uint32_t(std::max(at.y, 0.0f));
    return {std::min(face.x + x, grid.width - 1), std::min(face.y + y, grid.height - 1), at.x - float(x),
            at.y - float(y)};
  }
  static std::size_t subcell(const GridPoint& at) {
    const auto index = [](float t) { return std::clamp(int(t * float(kSubcells)), 0, kSubcells - 1); };
    return std::size_t(index(at.in_y) * kSubcells + index(at.in_x));
  }
  std::uint32_t element_on(const Face& face, const SurfaceHit& hit) const {
    if (face.system == kNone) return kNone;
    const Grid& grid = grids_[face.system];
    const GridPoint at = locate(face, grid, hit.u, hit.v);
    const std::uint32_t entry = grid.entry[std::size_t(at.y) * grid.width + at.x];
    if (entry == kNone || (entry & kSearch) == 0) return entry;
    const std::uint32_t fine = entry & ~kSearch;
    const std::uint32_t known = fine == kNoFineCell ? kSearch : fine_entry(face.system, fine, subcell(at));
    return known != kSearch ? known : search(hit, face.system, at.y * grid.width + at.x);
  }
  std::uint32_t fine_entry(std::uint32_t system, std::uint32_t fine, std::size_t subcell) const {
    std::atomic<std::uint32_t>& entry = grids_[system].fine[fine][subcell];
    std::uint32_t known = entry.load(std::memory_order_relaxed);
    if (known == kNone) {
      known = find_fine_entry(system, grids_[system].fine_cells[fine], subcell);
      entry.store(known, std::memory_order_relaxed);
    }
    return known;
  }
  void make_grid(const AtlasLayout& layout, std::uint32_t system);
  std::uint32_t find_fine_entry(std::uint32_t system, std::uint32_t cell, std::size_t wanted) const;
  std::uint32_t seen_from_behind(std::uint32_t triangle, float u, float v, const glm::vec3& direction) const;
  struct Candidates;
  void add_candidates(const SurfacePoint& point, std::uint32_t material, std::uint32_t system,
                      std::uint32_t cell, Candidates& candidates) const;
  std::uint32_t nearest_seen(const SurfacePoint& point, Candidates& candidates,
                             std::uint32_t first_element) const;
  /// headroom() the middle of an element of all systems.
  float headroom_over(std::uint32_t element, const SurfacePoint& middle) const;
  std::uint32_t search(const SurfaceHit& hit, std::uint32_t system, std::uint32_t cell) const;

  const Geometry& geometry_;
  const std::vector<Chart>& charts_;
  const std::vector<ClusteredSurface>& surfaces_;
  const RayCaster& caster_;
  std::vector<Face> front_, back_;
  std::vector<Grid> grids_;
  std::vector<std::uint32_t> first_elements_;  ///< per system
  std::vector<ElementOwner> owners_;           ///< per element of all systems
  /// Per element of all systems: headroom_over(), below 0 until somebody asks. Others who ask meanwhile find
  /// the same.
  mutable std::vector<std::atomic<float>> headrooms_;
};

}  // namespace relume
