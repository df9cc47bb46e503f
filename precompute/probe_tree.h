// SPDX-License-Identifier: MIT
//
// The octree of cells between light probes while it grows.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <set>
#include <span>
#include <vector>

#include "precompute/place_probes.h"
#include "precompute/probe_cells.h"
#include "precompute/probe_lattice.h"

namespace relume {

/// A cell while the tree grows: its lower corner and edge in steps of the lattice.
struct OpenCell {
  LatticePoint lower{};
  std::int32_t edge = 1;
  std::uint32_t first_child = 0;  ///< of eight, numbered as corners; 0: none
  CutCell cut{};
  std::vector<std::uint32_t> samples{};  ///< of the critic, that lie in it
  double free = 0.0;                     ///< volume of its free space, in cubes of the lattice's step
  double loss = 0.0;                     ///< that times the mean square of what is off in it
};

/// Root cells of `edge` (m) over the box of the geometry, in the middle of it.
ProbeVolume root_volume(const Geometry& geometry, double edge);

class ProbeTree {
 public:
  /// Borrows `geometry` and `caster`. Cells can be halved `depth` times.
  ProbeTree(const Geometry& geometry, const RayCaster& caster, const ProbeVolume& roots, std::uint32_t depth);

  std::vector<OpenCell>& cells() { return cells_; }
  const std::vector<OpenCell>& cells() const { return cells_; }
  float edge_of(const OpenCell& cell) const { return step_ * float(cell.edge); }
  const ProbeLattice& lattice() const { return lattice_; }

  /// Places at which halving a cell needs probes that no other cell has, but 1 at least.
  double cost_of_halving(const OpenCell& cell) const;

  /// Each of these cells becomes eight, which are the last cells afterwards.
  void halve(std::span<const std::uint32_t> halved);

  /// Probes that no cell uses are left out.
  PlacedProbes finish();

 private:
  void cut_from(std::size_t first);
  void fill_volume();

  const Geometry& geometry_;
  const RayCaster& caster_;
  ProbeVolume volume_;  ///< its nodes, cells and planes at the end
  ProbeLattice lattice_;
  float step_;
  std::vector<OpenCell> cells_;     ///< first the roots
  std::set<LatticePoint> corners_;  ///< of all cells
};

}  // namespace relume
