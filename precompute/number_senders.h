// SPDX-License-Identifier: MIT
//
// Numbers senders in the order of their cluster trees, once the rays have shown what sees what.
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/cluster_tree.h"
#include "precompute/emitters.h"
#include "precompute/rows.h"
#include "precompute/sender_lookup.h"

namespace relume {

/// The senders of a model in the order of their tree: the clusters of all systems, then the sky patches.
/// Clusters of one system may lie apart in it; among each other they have the order that the system has.
struct SenderTree {
  ClusterTree tree;                      ///< over all of them
  std::vector<SenderRef> places;         ///< per sender: the cluster of a system, or the sky patch
  std::vector<double> weights;           ///< per sender: area (m2), or solid angle
  std::vector<std::uint32_t> sky_cells;  ///< per sky patch: its cell; those that some row sees
};

/// Gives clusters and sky cells new numbers, in `surfaces` and in all rows. Every cluster tree holds clusters
/// of one room, and possible emitters or others; above the parts of it that are in one system each, its nodes
/// span systems. Rooms are what light can reach: clusters are in
/// one room when a chain of form factors joins them, the sky left aside. So no node lies on two sides of a
/// wall that seals.
SenderTree number_senders(const Emitters& emitters, std::uint32_t sky_resolution,
                          std::vector<ClusteredSurface>& surfaces, std::vector<SystemRows>& rows,
                          std::vector<FormFactorRow>& sensor_rows);

/// Per sensor: the system that its row sees most of, so that it is loaded with it; 0 for one that sees none.
std::vector<std::uint32_t> systems_of_sensors(const SenderTree& senders, std::size_t systems,
                                              const std::vector<FormFactorRow>& sensor_rows);

}  // namespace relume
