// SPDX-License-Identifier: MIT
#include "precompute/probe_tree.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <map>
#include <numeric>

namespace relume {
namespace {

LatticePoint corner_of(const OpenCell& cell, std::uint32_t corner) {
  LatticePoint at = cell.lower;
  for (std::size_t axis = 0; axis < 3; ++axis) at[axis] += (corner >> axis & 1u) != 0 ? cell.edges[axis] : 0;
  return at;
}

CellSplit split_of(const OpenCell& cell, std::uint32_t axis) {
  CellSplit split{axis, {OpenCell{cell.lower, cell.edges}, OpenCell{cell.lower, cell.edges}}};
  for (OpenCell& half : split.halves) half.edges[axis] /= 2;
  split.halves[1].lower[axis] += split.halves[1].edges[axis];
  return split;
}

glm::dvec3 size_of(const Geometry& geometry) {
  return glm::dvec3(geometry.upper) - glm::dvec3(geometry.lower);
}

std::array<std::uint32_t, 3> cells_along(const glm::dvec3& size, double edge) {
  std::array<std::uint32_t, 3> counts{};
  for (int axis = 0; axis < 3; ++axis)
    counts[std::size_t(axis)] = std::uint32_t(std::max(1.0, std::ceil(size[axis] / edge - 1e-6)));
  return counts;
}

glm::dvec3 to_vector(const std::array<std::uint32_t, 3>& counts) {
  return {double(counts[0]), double(counts[1]), double(counts[2])};
}

}  // namespace

ProbeVolume cubic_roots(const Geometry& geometry, double edge) {
  ProbeVolume volume;
  const glm::dvec3 size = size_of(geometry);
  volume.counts = cells_along(size, edge);
  volume.lower = glm::vec3(glm::dvec3(geometry.lower) - 0.5 * (edge * to_vector(volume.counts) - size));
  volume.edges = glm::vec3(float(edge));
  return volume;
}

ProbeVolume fitted_roots(const Geometry& geometry, double edge) {
  ProbeVolume volume;
  const glm::dvec3 size = glm::max(size_of(geometry), glm::dvec3(edge));
  volume.counts = cells_along(size, edge);
  volume.lower = glm::vec3(glm::dvec3(geometry.lower) - 0.5 * (size - size_of(geometry)));
  volume.edges = glm::vec3(size / to_vector(volume.counts));
  return volume;
}

ProbeTree::ProbeTree(const Geometry& geometry, const RayCaster& caster, const ProbeVolume& roots,
                     std::uint32_t depth)
    : geometry_(geometry),
      caster_(caster),
      volume_(roots),
      lattice_(geometry, caster, roots.lower, roots.edges / float(1u << depth)) {
  const auto edge = std::int32_t(1u << depth);
  for (std::uint32_t i = 0; i < roots.counts[0] * roots.counts[1] * roots.counts[2]; ++i) {
    const std::uint32_t x = i % roots.counts[0], yz = i / roots.counts[0];
    const std::uint32_t y = yz % roots.counts[1], z = yz / roots.counts[1];
    cells_.push_back(
        {{std::int32_t(x) * edge, std::int32_t(y) * edge, std::int32_t(z) * edge}, {edge, edge, edge}});
  }
  std::vector<const OpenCell*> added;
  for (const OpenCell& cell : cells_) {
    added.push_back(&cell);
    for (std::uint32_t c = 0; c < 8; ++c) corners_.insert(corner_of(cell, c));
  }
  add_corners(added);
  tbb::parallel_for(std::size_t{0}, cells_.size(), [&](std::size_t i) { cut(cells_[i]); });
}

void ProbeTree::propose(std::size_t first) {
  splits_.resize(cells_.size());
  for (std::size_t i = first; i < cells_.size(); ++i) {
    for (std::uint32_t axis = 0; axis < 3 && cells_[i].loss > 0.0; ++axis) {
      if (cells_[i].edges[axis] >= 2) splits_[i].push_back(split_of(cells_[i], axis));
    }
  }
  std::vector<const OpenCell*> added;
  for (std::size_t i = first; i < cells_.size(); ++i) {
    for (const CellSplit& split : splits_[i]) {
      for (const OpenCell& half : split.halves) added.push_back(&half);
    }
  }
  add_corners(added);
  tbb::parallel_for(first, cells_.size(), [&](std::size_t i) {
    for (CellSplit& split : splits_[i]) {
      for (OpenCell& half : split.halves) cut(half);
    }
  });
}

double ProbeTree::cost_of(const CellSplit& split) const {
  double added = 0.0;
  for (std::uint32_t c = 0; c < 8; ++c) {
    const LatticePoint at = corner_of(split.halves[1], c);
    if ((c >> split.axis & 1u) == 0 && !corners_.contains(at) && lattice_.probe(at) != kNoProbe) added += 1.0;
  }
  return added;
}

void ProbeTree::split(std::span<const ChosenSplit> chosen) {
  for (const ChosenSplit& choice : chosen) {
    CellSplit split = std::move(splits_[choice.cell][choice.split]);
    cells_[choice.cell].first_child = std::uint32_t(cells_.size());
    cells_[choice.cell].axis = split.axis;
    splits_[choice.cell].clear();
    cells_[choice.cell].cut = {};
    for (OpenCell& half : split.halves) {
      for (std::uint32_t c = 0; c < 8; ++c) corners_.insert(corner_of(half, c));
      cells_.push_back(std::move(half));
    }
  }
}

PlacedProbes ProbeTree::finish() {
  fill_volume();
  std::vector<std::uint32_t> number(lattice_.positions().size(), kNoProbe);
  PlacedProbes placed;
  for (ProbeCell& cell : volume_.cells) {
    for (std::uint32_t& probe : cell.probes) {
      if (probe == kNoProbe) continue;
      if (number[probe] == kNoProbe) {
        number[probe] = std::uint32_t(placed.points.size());
        placed.points.push_back({fmt::format("{}", placed.points.size()),
                                 geometry_.origin + glm::dvec3(lattice_.positions()[probe])});
      }
      probe = number[probe];
    }
  }
  placed.volume = std::move(volume_);
  return placed;
}

/// Probes at the corners of cells; larger cells go first, for their probes may move further.
void ProbeTree::add_corners(std::span<const OpenCell* const> cells) {
  std::map<LatticePoint, std::vector<LatticePoint>, std::greater<>> points;
  for (const OpenCell* cell : cells) {
    for (std::uint32_t c = 0; c < 8; ++c) points[cell->edges].push_back(corner_of(*cell, c));
  }
  for (auto& [edges, list] : points) lattice_.add(std::move(list), lattice_.size(edges));
}

/// What each of its probes sees of it.
void ProbeTree::cut(OpenCell& cell) const {
  std::array<std::uint32_t, 8> probes;
  for (std::uint32_t c = 0; c < 8; ++c) probes[c] = lattice_.probe(corner_of(cell, c));
  cell.cut =
      cut_cell(geometry_, caster_, probes, lattice_.positions(), lattice_.place(cell.lower), edges_of(cell));
}

/// Level by level, as ProbeVolume has it.
void ProbeTree::fill_volume() {
  const std::size_t roots = std::size_t{volume_.counts[0]} * volume_.counts[1] * volume_.counts[2];
  std::vector<std::uint32_t> order(roots);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t n = 0; n < order.size(); ++n) {
    const OpenCell& cell = cells_[order[n]];
    if (cell.first_child != 0) {
      volume_.nodes.push_back(std::uint32_t(order.size()) | cell.axis << kProbeAxisShift);
      order.insert(order.end(), {cell.first_child, cell.first_child + 1});
    } else if (cell.cut.covered > 0.0) {
      volume_.nodes.push_back(kProbeCellBit | std::uint32_t(volume_.cells.size()));
      volume_.cells.push_back(cell.cut.cell);
      volume_.cells.back().first_plane = std::uint32_t(volume_.planes.size());
      volume_.planes.insert(volume_.planes.end(), cell.cut.planes.begin(), cell.cut.planes.end());
    } else {
      volume_.nodes.push_back(kNoProbe);
    }
  }
}

}  // namespace relume
