// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "precompute/geometry.h"
#include "precompute/row_tracer.h"

namespace relume {

/// Rooms (core/rooms.h) from rows as they are traced. `rows`, `centroids`, `areas` per cluster; senders
/// beyond the clusters (the sky) are left aside. Returns the room of each cluster, numbered from 0 in the
/// order of their first clusters.
std::vector<std::uint32_t> find_rooms(const std::vector<FormFactorRow>& rows,
                                      const std::vector<glm::vec3>& centroids,
                                      const std::vector<float>& areas);

}  // namespace relume
