// SPDX-License-Identifier: MIT
#include "precompute/probe_tree.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace relume {
namespace {

/// Corners, middles of edges and of faces, and the middle of a cell.
constexpr int kPlaces = 27;

/// One of them, x fastest.
LatticePoint place(const OpenCell& cell, int i) {
  const std::int32_t half = cell.edge / 2;
  return {cell.lower[0] + half * (i % 3), cell.lower[1] + half * (i / 3 % 3), cell.lower[2] + half * (i / 9)};
}

LatticePoint corner_of(const OpenCell& cell, std::int32_t edge, std::uint32_t corner) {
  return {cell.lower[0] + ((corner & 1u) != 0 ? edge : 0), cell.lower[1] + ((corner & 2u) != 0 ? edge : 0),
          cell.lower[2] + ((corner & 4u) != 0 ? edge : 0)};
}

}  // namespace

ProbeVolume root_volume(const Geometry& geometry, double edge) {
  ProbeVolume volume;
  const glm::dvec3 size = glm::dvec3(geometry.upper) - glm::dvec3(geometry.lower);
  glm::dvec3 whole(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    volume.counts[std::size_t(axis)] = std::uint32_t(std::max(1.0, std::ceil(size[axis] / edge - 1e-6)));
    whole[axis] = edge * volume.counts[std::size_t(axis)];
  }
  volume.lower = glm::vec3(glm::dvec3(geometry.lower) - 0.5 * (whole - size));
  volume.edge = float(edge);
  return volume;
}

ProbeTree::ProbeTree(const Geometry& geometry, const RayCaster& caster, const ProbeVolume& roots,
                     std::uint32_t depth)
    : geometry_(geometry),
      caster_(caster),
      volume_(roots),
      lattice_(geometry, caster, roots.lower, roots.edge / float(1u << depth)),
      step_(roots.edge / float(1u << depth)) {
  const auto edge = std::int32_t(1u << depth);
  for (std::uint32_t i = 0; i < roots.counts[0] * roots.counts[1] * roots.counts[2]; ++i) {
    const std::uint32_t x = i % roots.counts[0], yz = i / roots.counts[0];
    const std::uint32_t y = yz % roots.counts[1], z = yz / roots.counts[1];
    cells_.push_back({{std::int32_t(x) * edge, std::int32_t(y) * edge, std::int32_t(z) * edge}, edge});
  }
  cut_from(0);
}

double ProbeTree::cost_of_halving(const OpenCell& cell) const {
  double added = 0.0;
  for (int k = 0; k < kPlaces; ++k) added += corners_.contains(place(cell, k)) ? 0.0 : 1.0;
  return std::max(added, 1.0);
}

void ProbeTree::halve(std::span<const std::uint32_t> halved) {
  const std::size_t first = cells_.size();
  for (const std::uint32_t i : halved) {
    cells_[i].first_child = std::uint32_t(cells_.size());
    cells_[i].cut = {};
    for (std::uint32_t c = 0; c < 8; ++c) {
      const std::int32_t edge = cells_[i].edge / 2;
      cells_.push_back({corner_of(cells_[i], edge, c), edge});
    }
  }
  cut_from(first);
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

/// Probes at the corners of the cells from `first` on, and what each sees of its cell.
void ProbeTree::cut_from(std::size_t first) {
  std::map<std::int32_t, std::vector<LatticePoint>> points;
  for (std::size_t i = first; i < cells_.size(); ++i) {
    for (std::uint32_t c = 0; c < 8; ++c)
      points[cells_[i].edge].push_back(corner_of(cells_[i], cells_[i].edge, c));
  }
  for (auto& [edge, list] : points) {
    corners_.insert(list.begin(), list.end());
    lattice_.add(std::move(list), step_ * float(edge));
  }
  tbb::parallel_for(first, cells_.size(), [&](std::size_t i) {
    std::array<std::uint32_t, 8> probes;
    for (std::uint32_t c = 0; c < 8; ++c) probes[c] = lattice_.probe(corner_of(cells_[i], cells_[i].edge, c));
    cells_[i].cut = cut_cell(geometry_, caster_, probes, lattice_.positions(),
                             lattice_.place(cells_[i].lower), edge_of(cells_[i]));
  });
}

/// Level by level, as ProbeVolume has it.
void ProbeTree::fill_volume() {
  const std::size_t roots = std::size_t{volume_.counts[0]} * volume_.counts[1] * volume_.counts[2];
  std::vector<std::uint32_t> order(roots);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t n = 0; n < order.size(); ++n) {
    const OpenCell& cell = cells_[order[n]];
    if (cell.first_child != 0) {
      volume_.nodes.push_back(std::uint32_t(order.size()));
      for (std::uint32_t c = 0; c < 8; ++c) order.push_back(cell.first_child + c);
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
