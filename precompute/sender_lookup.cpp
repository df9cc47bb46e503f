// SPDX-License-Identifier: MIT
#include "precompute/sender_lookup.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

namespace relume {
namespace {

/// Whether a cell has one element, and no wall is near.
bool whole(const SystemSurface& surface, std::uint32_t cell) {
  const auto first = surface.first_element[cell], last = surface.first_element[cell + 1];
  return last == first + 1 && !surface.elements[first].walled;
}

/// Cells without surface take a neighbour's entry: hits on a border may round into them. Charts stand two
/// cells apart.
void dilate(std::vector<std::uint32_t>& entries, std::uint32_t width, std::uint32_t height) {
  const auto original = entries;
  for (int y = 0; y < int(height); ++y) {
    for (int x = 0; x < int(width); ++x) {
      std::uint32_t& entry = entries[std::size_t(y) * width + std::size_t(x)];
      for (int step = 0; step < 9 && entry == kNone; ++step) {
        const int nx = x + step % 3 - 1, ny = y + step / 3 - 1;
        if (nx < 0 || ny < 0 || nx >= int(width) || ny >= int(height)) continue;
        entry = original[std::size_t(ny) * width + std::size_t(nx)];
      }
    }
  }
}

/// Corners are looked at this share of the way to the middle of their piece: one that lies in the edge of a
/// wall would see nothing.
constexpr float kCornerInset = 0.01f;

}  // namespace

SenderLookup::SenderLookup(const Geometry& geometry, const std::vector<Chart>& charts,
                           const std::vector<AtlasLayout>& layouts,
                           const std::vector<ClusteredSurface>& surfaces, const RayCaster& caster)
    : geometry_(geometry),
      charts_(charts),
      surfaces_(surfaces),
      caster_(caster),
      front_(geometry.triangles.size()) {
  for (std::size_t t = 0; t < front_.size(); ++t) front_[t].normal = geometry.normals[t];
  const bool any_back =
      std::any_of(charts.begin(), charts.end(), [](const Chart& c) { return c.side == Side::back; });
  if (any_back) back_.resize(geometry.triangles.size());
  std::uint32_t elements = 0;
  for (std::uint32_t s = 0; s < layouts.size(); ++s) {
    first_elements_.push_back(elements);
    elements += std::uint32_t(surfaces[s].surface.elements.size());
    for (std::size_t i = 0; i < layouts[s].charts.size(); ++i)
      map_chart(charts[layouts[s].charts[i]], layouts[s].positions[i], s);
    make_grid(layouts[s], s);
  }
  owners_.resize(elements);
  headrooms_ = std::vector<std::atomic<float>>(elements);
  for (auto& free : headrooms_) free.store(-1.0f, std::memory_order_relaxed);
  follow_clusters();
}

void SenderLookup::make_grid(const AtlasLayout& layout, std::uint32_t system) {
  const SystemSurface& surface = surfaces_[system].surface;
  Grid grid{layout.width, layout.height, {}, {}, {}};
  grid.entry.assign(std::size_t(grid.width) * grid.height, kNone);
  for (std::uint32_t cell = 0; cell < grid.entry.size(); ++cell) {
    const std::uint32_t first = surface.first_element[cell];
    if (first == surface.first_element[cell + 1]) continue;
    grid.entry[cell] = whole(surface, cell) ? first_elements_[system] + first : kSearch | kNoFineCell;
  }
  dilate(grid.entry, grid.width, grid.height);
  for (std::uint32_t cell = 0; cell < grid.entry.size(); ++cell) {
    const bool covered = surface.first_element[cell] < surface.first_element[cell + 1];
    if (!covered || grid.entry[cell] != (kSearch | kNoFineCell)) continue;
    grid.entry[cell] = kSearch | std::uint32_t(grid.fine_cells.size());
    grid.fine_cells.push_back(cell);
  }
  grid.fine = std::vector<FineCell>(grid.fine_cells.size());
  for (FineCell& fine : grid.fine) {
    for (auto& entry : fine) entry.store(kNone, std::memory_order_relaxed);
  }
  grids_.push_back(std::move(grid));
}

/// A sub-cell is known when the corners of all pieces in it find one element: then no wall cuts it.
std::uint32_t SenderLookup::find_fine_entry(std::uint32_t system, std::uint32_t cell,
                                            std::size_t wanted) const {
  const SystemSurface& surface = surfaces_[system].surface;
  std::uint32_t known = kNone;
  for (auto e = surface.first_element[cell]; e < surface.first_element[cell + 1]; ++e) {
    const Element& element = surface.elements[e];
    const Side side = charts_[element.chart].side;
    for (std::uint32_t p = 0; p < element.piece_count; ++p) {
      const SurfacePiece& shape = surface.pieces[element.first_piece + p].shape;
      const glm::vec2 middle = (shape.corners[0] + shape.corners[1] + shape.corners[2]) / 3.0f;
      const Face& face = side == Side::front ? front_[shape.triangle] : back_[shape.triangle];
      if (subcell(locate(face, grids_[system], middle.x, middle.y)) != wanted) continue;
      for (const glm::vec2& corner : shape.corners) {
        const glm::vec2 at = glm::mix(corner, middle, kCornerInset);
        const std::uint32_t found = search({shape.triangle, at.x, at.y, side}, system, cell);
        if (found == kNone || (known != kNone && known != found)) return kSearch;
        known = found;
      }
    }
  }
  return known == kNone ? kSearch : known;
}

void SenderLookup::map_chart(const Chart& chart, const glm::uvec2& position, std::uint32_t system) {
  auto& faces = chart.side == Side::front ? front_ : back_;
  for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
    const std::uint32_t t = chart.triangles[i];
    const auto& c = chart.corners[i];
    faces[t] = {geometry_.normals[t],     c[0], c[1] - c[0], c[2] - c[0], system, std::uint16_t(position.x),
                std::uint16_t(position.y)};
  }
}

void SenderLookup::follow_clusters() {
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    for (std::uint32_t e = 0; e < surfaces_[s].cluster.size(); ++e)
      owners_[first_elements_[s] + e] = {surfaces_[s].sender_of(e), !simple(s, e)};
  }
}

std::uint32_t SenderLookup::element(const SurfaceHit& hit) const {
  return element_on(hit.side == Side::front ? front_[hit.triangle] : back_[hit.triangle], hit);
}

std::uint32_t SenderLookup::seen(const RayPacket& rays,
                                 std::array<std::uint32_t, kPacketSize>& places) const {
  if (grids_.empty()) return 0;
  // Without branches, and no lane waits for the memory of another.
  static constexpr std::uint32_t kAskAlone = kNone;
  std::array<const std::uint32_t*, kPacketSize> entries;
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    const bool met = rays.triangle[lane] != kNoTriangle;
    const Face& face = front_[met ? rays.triangle[lane] : 0];
    const glm::vec3 direction(rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]);
    const bool plain = met & (glm::dot(face.normal, direction) < 0.0f) & (face.system != kNone);
    const Grid& grid = grids_[plain ? face.system : 0];
    const GridPoint at = locate(face, grid, plain ? rays.u[lane] : 0.0f, plain ? rays.v[lane] : 0.0f);
    const std::uint32_t* entry = grid.entry.data() + std::size_t(at.y) * grid.width + at.x;
    entries[lane] = plain ? entry : &kAskAlone;
  }
  std::uint32_t known = 0;
  for (std::size_t lane = 0; lane < std::size_t(kPacketSize); ++lane) {
    places[lane] = *entries[lane];
    known |= (places[lane] >> 31 ^ 1u) << lane;
  }
  return known;
}

std::uint32_t SenderLookup::seen_from_behind(std::uint32_t triangle, float u, float v,
                                             const glm::vec3& direction) const {
  const auto hit = seen_surface(geometry_, {triangle, u, v, Side::back}, direction);
  return hit ? element(*hit) : kBlackBack;
}

float SenderLookup::headroom_over(std::uint32_t element, const SurfacePoint& middle) const {
  std::atomic<float>& known = headrooms_[element];
  float free = known.load(std::memory_order_relaxed);
  if (free < 0.0f) {
    free = headroom(geometry_, caster_, middle, std::numeric_limits<float>::infinity());
    known.store(free, std::memory_order_relaxed);
  }
  return free;
}

/// Elements of the lumels around a point that agree with it in material and face the same way.
struct SenderLookup::Candidates {
  struct One {
    float distance;
    std::uint32_t element;  ///< of the system
    SurfacePoint middle;
  };
  static constexpr std::size_t kMost = 48;
  std::array<One, kMost> list;
  std::size_t count = 0;
  float furthest = 0.0f;  ///< distance, m

  std::span<One> all() { return std::span(list).first(count); }
};

void SenderLookup::add_candidates(const SurfacePoint& point, std::uint32_t material, std::uint32_t system,
                                  std::uint32_t cell, Candidates& candidates) const {
  const SystemSurface& surface = surfaces_[system].surface;
  for (auto e = surface.first_element[cell]; e < surface.first_element[cell + 1]; ++e) {
    const Element& element = surface.elements[e];
    const bool agrees = element.material == material && glm::dot(element.normal, point.normal) > 0.5f;
    if (!agrees || candidates.count == Candidates::kMost) continue;
    const SurfacePoint middle{element.position, element.normal};
    const float distance = glm::length(middle.position - point.position);
    candidates.list[candidates.count++] = {distance, e, middle};
    candidates.furthest = std::max(candidates.furthest, distance);
  }
}

std::uint32_t SenderLookup::search(const SurfaceHit& hit, std::uint32_t system, std::uint32_t cell) const {
  const Grid& grid = grids_[system];
  const SurfacePoint point{geometry_.point(hit.triangle, hit.u, hit.v),
                           geometry_.normal(hit.triangle, hit.side)};
  Candidates candidates;
  const int cx = int(cell % grid.width), cy = int(cell / grid.width);
  for (int step = 0; step < 9; ++step) {
    const int x = cx + step % 3 - 1, y = cy + step / 3 - 1;
    if (x < 0 || y < 0 || x >= int(grid.width) || y >= int(grid.height)) continue;
    add_candidates(point, geometry_.material[hit.triangle], system,
                   std::uint32_t(y) * grid.width + std::uint32_t(x), candidates);
  }
  return nearest_seen(point, candidates, first_elements_[system]);
}

std::uint32_t SenderLookup::nearest_seen(const SurfacePoint& point, Candidates& candidates,
                                         std::uint32_t first_element) const {
  if (candidates.count == 0) return kNone;
  const float own = headroom(geometry_, caster_, point, kMostLift * candidates.furthest);
  const auto before = [](const Candidates::One& a, const Candidates::One& b) {
    return a.distance < b.distance || (a.distance == b.distance && a.element < b.element);
  };
  // It is seldom not the first that is seen: they are not sorted.
  for (auto rest = candidates.all(); !rest.empty(); rest = rest.subspan(1)) {
    std::iter_swap(rest.begin(), std::min_element(rest.begin(), rest.end(), before));
    const std::uint32_t element = first_element + rest[0].element;
    const SurfacePoint& middle = rest[0].middle;
    if (mutually_visible(geometry_, caster_, point, own, middle, headroom_over(element, middle)))
      return element;
  }
  return kNone;
}

}  // namespace relume
