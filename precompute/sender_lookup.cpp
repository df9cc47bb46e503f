// SPDX-License-Identifier: MIT
#include "precompute/sender_lookup.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace relume {
namespace {

constexpr std::uint32_t kSearch = 0x80000000u;

/// Entry of one cell: its cluster where all of its elements agree and no wall is near.
std::uint32_t entry_of_cell(const ClusteredSurface& system, std::uint32_t cell) {
  const auto first = system.surface.first_element[cell], last = system.surface.first_element[cell + 1];
  if (first == last) return kNone;
  for (auto e = first; e < last; ++e) {
    if (system.surface.elements[e].walled || system.cluster[e] != system.cluster[first])
      return kSearch | cell;
  }
  return system.first_cluster + system.cluster[first];
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

}  // namespace

SenderLookup::SenderLookup(const Geometry& geometry, const std::vector<Chart>& charts,
                           const std::vector<SystemLayout>& layouts,
                           const std::vector<ClusteredSurface>& surfaces, const RayCaster& caster)
    : geometry_(geometry), surfaces_(surfaces), caster_(caster), front_(geometry.triangles.size()) {
  const bool any_back =
      std::any_of(charts.begin(), charts.end(), [](const Chart& c) { return c.side == Side::back; });
  if (any_back) back_.resize(geometry.triangles.size());
  for (std::uint32_t s = 0; s < layouts.size(); ++s) {
    for (std::size_t i = 0; i < layouts[s].charts.size(); ++i)
      map_chart(charts[layouts[s].charts[i]], layouts[s].positions[i], s);
    Grid grid{layouts[s].width, layouts[s].height,
              std::vector<std::uint32_t>(std::size_t(layouts[s].width) * layouts[s].height)};
    for (std::uint32_t cell = 0; cell < grid.entry.size(); ++cell)
      grid.entry[cell] = entry_of_cell(surfaces[s], cell);
    dilate(grid.entry, grid.width, grid.height);
    grids_.push_back(std::move(grid));
  }
}

void SenderLookup::map_chart(const Chart& chart, const glm::uvec2& position, std::uint32_t system) {
  auto& mappings = chart.side == Side::front ? front_ : back_;
  for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
    const auto& c = chart.corners[i];
    mappings[chart.triangles[i]] = {c[0] + glm::vec2(position), c[1] - c[0], c[2] - c[0], system};
  }
}

std::uint32_t SenderLookup::sender(const SurfaceHit& hit) const {
  const Mapping& mapping = hit.side == Side::front ? front_[hit.triangle] : back_[hit.triangle];
  if (mapping.system == kNone) return kNone;
  const Grid& grid = grids_[mapping.system];
  const glm::vec2 at = mapping.base + mapping.du * hit.u + mapping.dv * hit.v;
  const auto x = std::min(std::uint32_t(std::max(at.x, 0.0f)), grid.width - 1);
  const auto y = std::min(std::uint32_t(std::max(at.y, 0.0f)), grid.height - 1);
  const std::uint32_t entry = grid.entry[std::size_t(y) * grid.width + x];
  if (entry == kNone || (entry & kSearch) == 0) return entry;
  return search(hit, mapping.system, entry & ~kSearch);
}

std::uint32_t SenderLookup::search(const SurfaceHit& hit, std::uint32_t system, std::uint32_t cell) const {
  const ClusteredSurface& own = surfaces_[system];
  const Grid& grid = grids_[system];
  const SurfacePoint point{geometry_.point(hit.triangle, hit.u, hit.v),
                           geometry_.normal(hit.triangle, hit.side)};
  const std::uint32_t material = geometry_.material[hit.triangle];
  struct Candidate {
    float distance;
    std::uint32_t element;
  };
  constexpr std::size_t kMaxCandidates = 48;
  std::array<Candidate, kMaxCandidates> candidates;
  std::size_t count = 0;
  const int cx = int(cell % grid.width), cy = int(cell / grid.width);
  for (int step = 0; step < 9; ++step) {
    const int x = cx + step % 3 - 1, y = cy + step / 3 - 1;
    if (x < 0 || y < 0 || x >= int(grid.width) || y >= int(grid.height)) continue;
    const std::uint32_t neighbour = std::uint32_t(y) * grid.width + std::uint32_t(x);
    for (auto e = own.surface.first_element[neighbour]; e < own.surface.first_element[neighbour + 1]; ++e) {
      const Element& element = own.surface.elements[e];
      const bool agrees = element.material == material && glm::dot(element.normal, point.normal) > 0.5f;
      if (agrees && count < kMaxCandidates)
        candidates[count++] = {glm::length(element.position - point.position), e};
    }
  }
  std::sort(candidates.begin(), candidates.begin() + std::ptrdiff_t(count),
            [](const Candidate& a, const Candidate& b) {
              return a.distance < b.distance || (a.distance == b.distance && a.element < b.element);
            });
  for (std::size_t i = 0; i < count; ++i) {
    const Element& element = own.surface.elements[candidates[i].element];
    if (mutually_visible(geometry_, caster_, point, {element.position, element.normal})) {
      return own.first_cluster + own.cluster[candidates[i].element];
    }
  }
  return kNone;
}

}  // namespace relume
