// SPDX-License-Identifier: MIT
//
// The tree of cells between light probes while it grows.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <set>
#include <span>
#include <vector>

#include "precompute/place_probes.h"
#include "precompute/probe_cells.h"
#include "precompute/probe_lattice.h"

namespace relume {

/// A cell while the tree grows: its lower corner and edges in steps of the lattice.
struct OpenCell {
  LatticePoint lower{};
  LatticePoint edges{1, 1, 1};
  std::uint32_t first_child = 0;  ///< of two, the lower one first; 0: none
  std::uint32_t axis = 0;         ///< across which they lie
  CutCell cut{};
  std::vector<std::uint32_t> samples{};  ///< of the critic, that lie in it
  double free = 0.0;                     ///< volume of its free space, in boxes of the lattice's steps
  double loss = 0.0;                     ///< that times the mean square of what is off in it
};

/// The halves of a cell across an axis.
struct CellSplit {
  std::uint32_t axis = 0;
  std::array<OpenCell, 2> halves{};
};

/// A cell that is to be halved, by one of its splits.
struct ChosenSplit {
  std::uint32_t cell = 0, split = 0;
};

/// Root cells of `edge` (m) over the box of the geometry, in the middle of it.
ProbeVolume cubic_roots(const Geometry& geometry, double edge);

/// As few root cells of at most `edge` (m) as fill the box of the geometry, which is taken to be no thinner
/// than `edge`.
ProbeVolume fitted_roots(const Geometry& geometry, double edge);

class ProbeTree {
 public:
  /// Borrows `geometry` and `caster`. Cells can be halved `depth` times across each axis.
  ProbeTree(const Geometry& geometry, const RayCaster& caster, const ProbeVolume& roots, std::uint32_t depth);

  std::vector<OpenCell>& cells() { return cells_; }
  const std::vector<OpenCell>& cells() const { return cells_; }
  /// What a cell could become; nothing where nobody asked.
  std::vector<CellSplit>& splits(std::size_t cell) { return splits_[cell]; }
  const std::vector<CellSplit>& splits(std::size_t cell) const { return splits_[cell]; }
  const ProbeLattice& lattice() const { return lattice_; }
  glm::vec3 edges_of(const OpenCell& cell) const { return lattice_.size(cell.edges); }

  /// Sets the splits of the cells from `first` on that lose something.
  void propose(std::size_t first);

  /// Probes that no cell has yet, of those that the halves need.
  double cost_of(const CellSplit& split) const;

  /// Each of these cells becomes two, which are the last cells afterwards.
  void split(std::span<const ChosenSplit> chosen);

  /// Probes that no cell uses are left out.
  PlacedProbes finish();

 private:
  void add_corners(std::span<const OpenCell* const> cells);
  void cut(OpenCell& cell) const;
  void fill_volume();

  const Geometry& geometry_;
  const RayCaster& caster_;
  ProbeVolume volume_;  ///< its nodes, cells and planes at the end
  ProbeLattice lattice_;
  std::vector<OpenCell> cells_;                 ///< first the roots
  std::vector<std::vector<CellSplit>> splits_;  ///< per cell
  std::set<LatticePoint> corners_;              ///< of all cells
};

}  // namespace relume
