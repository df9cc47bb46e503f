// SPDX-License-Identifier: MIT
//
// What light probes see: rays over the whole sphere, and area samples of possible emitters.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/result.h"
#include "precompute/geometry.h"
#include "precompute/precompute.h"
#include "precompute/rows.h"

namespace relume {

/// A sender, or a part of one, as seen from a probe.
struct SeenSender {
  std::uint32_t sender = 0;   ///< numbered through, as in FormFactorRow; of ProbeRows, a node of the tree
  float solid_angle = 0.0f;   ///< sr
  glm::vec3 direction{0.0f};  ///< mean of unit vectors towards it
};

struct ProbeRow {
  std::vector<SeenSender>
      senders;                   ///< ascending; solid angles add up to what is no back face and has a sender
  float back_face_share = 0.0f;  ///< of its rays
};

/// A probe of which more rays meet back faces is invalid: a few are seen through any gap, half of them from
/// behind a wall.
inline constexpr float kInvalidProbeShare = 0.25f;

struct ProbeRows {
  std::vector<ProbePoint> points;
  std::vector<ProbeRow> rows;          ///< per point
  std::vector<std::uint32_t> systems;  ///< per point: the one that it sees most of
};

/// Rows of `points` from so many rays each. A sender that spreads far around the probe is told in parts.
/// Cancelled when the observer says so.
Result<std::vector<ProbeRow>> trace_probes(const RowScene& scene, std::span<const ProbePoint> points,
                                           std::uint32_t rays, RowCounts& counts,
                                           const ProgressObserver& observer);

}  // namespace relume
