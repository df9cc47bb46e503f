// SPDX-License-Identifier: MIT
#include "precompute/unchanged_elements.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/geometric.hpp>

namespace relume {
namespace {

/// A hit is in the lumel of its element or in one beside that, and asks those around it.
constexpr int kNeighbourhood = 2;

/// Segments between points of a neighbourhood are lifted by up to this share of their length
/// (mutual_visibility.h).
constexpr float kLift = 0.6f;

/// Calls visit(element of the system) for all in the neighbourhood of one, and for itself.
template <class Visit>
void for_each_near(const SystemSurface& surface, const Element& element, Visit&& visit) {
  const int x = int(element.cell % surface.width), y = int(element.cell / surface.width);
  for (int ny = std::max(0, y - kNeighbourhood); ny <= std::min(int(surface.height) - 1, y + kNeighbourhood);
       ++ny) {
    for (int nx = std::max(0, x - kNeighbourhood); nx <= std::min(int(surface.width) - 1, x + kNeighbourhood);
         ++nx) {
      const std::size_t cell = std::size_t(ny) * surface.width + std::size_t(nx);
      for (auto e = surface.first_element[cell]; e < surface.first_element[cell + 1]; ++e) {
        if (surface.elements[e].chart == element.chart) visit(e);
      }
    }
  }
}

}  // namespace

std::vector<std::uint32_t> unchanged_elements(const Surfaces& surfaces, const SenderLookup& lookup,
                                              const std::vector<std::uint32_t>& old_of,
                                              const std::vector<bool>& settled,
                                              const std::function<bool(std::uint32_t, float)>& disturbed) {
  std::vector<std::uint32_t> result(old_of.size(), kNone);
  for (std::size_t s = 0; s < surfaces.systems.size(); ++s) {
    const SystemSurface& surface = surfaces.systems[s].surface;
    const std::uint32_t base = lookup.first_element(s);
    tbb::parallel_for(std::uint32_t{0}, std::uint32_t(surface.elements.size()), [&](std::uint32_t e) {
      const Element& element = surface.elements[e];
      const auto piece = surface.pieces.begin() + element.first_piece;
      const bool whole = std::all_of(piece, piece + element.piece_count,
                                     [&](const Piece& p) { return settled[p.shape.triangle]; });
      if (old_of[base + e] == kNone || !whole) return;
      // Keys say whether a wall is near: what is simple now was so before.
      bool simple = true, calm = true;
      float reach = 0.0f;
      for_each_near(surface, element, [&](std::uint32_t near) {
        calm = calm && old_of[base + near] != kNone;
        simple = simple && lookup.simple(s, near);
        reach = std::max(reach, glm::length(surface.elements[near].position - element.position));
      });
      if (calm && !simple) {
        for_each_near(surface, element, [&](std::uint32_t near) {
          calm = calm && !disturbed(base + near, kLift * 2.0f * reach);
        });
      }
      if (calm) result[base + e] = old_of[base + e];
    });
  }
  return result;
}

}  // namespace relume
