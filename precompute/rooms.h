// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/geometry.h"
#include "precompute/row_tracer.h"

namespace relume {

/// Rooms: groups of clusters that exchange most of their light among themselves. Clusters that no chain of
/// form factors joins are in different rooms, and so are those between which little passes: smooth functions
/// of the place, and random ones, averaged over what each cluster sees a few times over, become constant
/// inside a room long before they do across a door (after the relaxed test vectors of A. Brandt, O. Livne,
/// Lean Algebraic Multigrid, 2012).
///
/// `rows`, `centroids`, `areas` per cluster; senders beyond the clusters (the sky) are left aside. Returns
/// the room of each cluster, numbered from 0 in the order of their first clusters.
std::vector<std::uint32_t> find_rooms(const std::vector<FormFactorRow>& rows,
                                      const std::vector<glm::vec3>& centroids,
                                      const std::vector<float>& areas);

}  // namespace relume
