// SPDX-License-Identifier: MIT
//
// Which part of a cell each of its light probes sees, as planes (core/probe_volume.h).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "core/probe_volume.h"
#include "precompute/geometry.h"

namespace relume {

struct CutCell {
  ProbeCell cell;  ///< first_plane is 0
  std::vector<glm::vec4> planes;
  /// Shares of its volume: where some probe speaks, and free space where none does.
  double covered = 0.0, uncovered = 0.0;
};

/// The cell of `edges` (m) from `lower` on. Samples of it are looked at from each probe; those that are
/// hidden are cut off by planes of the surfaces that hide them, and with them as little as can be of what is
/// seen. A corner for which there is no plane left has no probe.
CutCell cut_cell(const Geometry& geometry, const RayCaster& caster,
                 const std::array<std::uint32_t, 8>& probes, std::span<const glm::vec3> positions,
                 const glm::vec3& lower, const glm::vec3& edges);

}  // namespace relume
