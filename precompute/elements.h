// SPDX-License-Identifier: MIT
//
// Surface elements of one system: every chart cut along the lumel grid, cells that a wall or a crease runs
// through cut further and regrouped so that no element lies on two sides of a wall, and the links between
// neighbours that see each other.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

#include "core/model.h"
#include "precompute/atlas.h"
#include "precompute/charts.h"
#include "precompute/geometry.h"
#include "precompute/mutual_visibility.h"

namespace relume {

class Views;

/// A triangle cut out of a triangle of the scene, with what grouping asks of it.
struct Piece {
  SurfacePiece shape;
  float area = 0.0f;        ///< m2, of its solid part (core/opacity.h); above 0
  std::uint32_t cell = 0;   ///< y * width + x of its lumel
  std::uint32_t chart = 0;  ///< index of its chart
};

/// Middle of a piece, with the normal of the given side.
SurfacePoint middle_of(const Geometry& geometry, const SurfacePiece& shape, Side side);

struct Element {
  glm::vec3 position{0.0f};  ///< a point of the surface near its middle
  glm::vec3 normal{0.0f};    ///< of the surface at `position`, towards the receiving side
  float area = 0.0f;
  std::uint32_t cell = 0;
  std::uint32_t chart = 0;
  std::uint32_t material = 0;
  std::uint32_t first_piece = 0;
  std::uint32_t piece_count = 0;
  bool walled = false;  ///< something blocks the view to a neighbour or across its own cell
  bool split = false;   ///< shares its cell with another element
};

struct SystemSurface {
  std::uint32_t width = 0, height = 0;
  std::vector<Piece> pieces;                 ///< grouped by element
  std::vector<Element> elements;             ///< ascending by cell
  std::vector<std::uint32_t> first_element;  ///< per cell, and the total at the end
  std::vector<std::pair<std::uint32_t, std::uint32_t>>
      links;  ///< elements of neighbouring cells that see each other
  std::uint64_t occlusion_rays = 0;
};

/// What is known of cells beforehand, from an earlier precompute.
struct KnownCells {
  /// Whether a cell with these pieces was one element that sees its neighbours.
  std::function<bool(const Element& cell, std::span<const Piece> pieces)> whole;
  /// Whether anything changed so near.
  std::function<bool(const glm::vec3& position, float reach)> disturbed;
};

/// Neighbours that are `known` to see each other are not asked; it may be missing.
SystemSurface make_elements(const Geometry& geometry, const std::vector<Chart>& charts,
                            const AtlasLayout& layout, Views& views, const KnownCells* known = nullptr);

/// All charts of the system cut along the lumel grid, ascending by cell.
std::vector<Piece> cut_into_cells(const Geometry& geometry, const std::vector<Chart>& charts,
                                  const AtlasLayout& layout);

/// Cuts the pieces of one cell along a grid of kSubcells x kSubcells, groups what agrees in material and
/// normal and is connected by visible neighbours, and drops what lies inside other geometry (all of it is
/// kept when nothing else would be left). Each group is the pieces of one element. Rays that were traced are
/// added to `rays`.
inline constexpr int kSubcells = 4;
std::vector<std::vector<Piece>> split_cell(const Geometry& geometry, const Chart& chart, Views& views,
                                           const std::vector<Piece>& pieces, std::uint64_t& rays);

}  // namespace relume
