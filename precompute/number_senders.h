// SPDX-License-Identifier: MIT
//
// Numbers senders in the order of their cluster trees.
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/cluster_tree.h"
#include "precompute/emitters.h"
#include "precompute/row_tracer.h"
#include "precompute/sender_lookup.h"

namespace relume {

/// The senders of a model, numbered through: the clusters of all systems, then the cells of the sky.
struct SenderTree {
  ClusterTree tree;             ///< over all of them; no node spans two systems
  std::vector<double> weights;  ///< per sender: area (m2), or solid angle
  std::uint32_t sky_resolution = 0;
  std::vector<std::uint32_t> sky_cells;  ///< per sender that is a cell of the sky, which one
};

/// As they are, without nodes: the tree is its leaves.
SenderTree plain_senders(std::uint32_t sky_resolution, const std::vector<ClusteredSurface>& surfaces);

/// Gives clusters new numbers, in `surfaces`, and returns what became of the old numbers of all senders in
/// `numbers`. Every cluster tree holds clusters of one system, one room (`rooms`, per cluster), and possible
/// emitters of one material or others: no node lies on two sides of a wall between rooms.
SenderTree number_senders(const Emitters& emitters, const std::vector<std::uint32_t>& rooms,
                          std::uint32_t sky_resolution, std::vector<ClusteredSurface>& surfaces,
                          std::vector<std::uint32_t>& numbers);

/// Gives the senders of rows their new numbers, and keeps them ascending.
void renumber(const std::vector<std::uint32_t>& numbers, std::vector<FormFactorRow>& rows);

}  // namespace relume
