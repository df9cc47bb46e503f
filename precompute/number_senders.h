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

/// The senders of a model in the order of their tree: the clusters of all systems, then the cells of the sky.
/// Clusters of one system may lie apart in it; among each other they have the order that the system has.
struct SenderTree {
  ClusterTree tree;               ///< over all of them
  std::vector<SenderRef> places;  ///< per sender: the cluster of a system, or the sky patch
  std::vector<double> weights;    ///< per sender: area (m2), or solid angle
  std::uint32_t sky_resolution = 0;
  std::vector<std::uint32_t> sky_cells;  ///< per sender that is a cell of the sky, which one
};

/// As they are, without nodes: the tree is its leaves.
SenderTree plain_senders(std::uint32_t sky_resolution, const std::vector<ClusteredSurface>& surfaces);

/// Gives clusters new numbers, in `surfaces`, and returns what became of the old numbers of all senders in
/// `numbers`. Every cluster tree holds clusters of one room (`rooms`, per cluster), and possible emitters of
/// one material or others: no node lies on two sides of a wall between rooms. Above the parts of it that are
/// in one system each, its nodes span systems.
SenderTree number_senders(const Emitters& emitters, const std::vector<std::uint32_t>& rooms,
                          std::uint32_t sky_resolution, std::vector<ClusteredSurface>& surfaces,
                          std::vector<std::uint32_t>& numbers);

/// Gives the senders of rows their new numbers, and keeps them ascending.
void renumber(const std::vector<std::uint32_t>& numbers, std::vector<FormFactorRow>& rows);

/// Per sensor: the system that its row sees most of, so that it is loaded with it; 0 for one that sees none.
std::vector<std::uint32_t> systems_of_sensors(const SenderTree& senders, std::size_t systems,
                                              const std::vector<FormFactorRow>& sensor_rows);

}  // namespace relume
