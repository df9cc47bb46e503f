// SPDX-License-Identifier: MIT
//
// All rows of a model: the same rays serve a cluster's row of K and its lumels' rows of G.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"
#include "precompute/precompute.h"
#include "precompute/row_tracer.h"

namespace relume {

struct SystemRows {
  std::vector<FormFactorRow> clusters;
  std::vector<FormFactorRow>
      elements;  ///< rows of the elements that are lumels' own; empty ones for the others
  std::vector<float> element_back_face_share;  ///< per element
};

struct RowOptions {
  std::uint32_t quality = 512;  ///< rays per element
  std::uint32_t sensor_quality = 8192;
  std::vector<std::uint32_t> node_quality =
      {};  ///< rays per element of each node of the scene; empty: `quality`
};

struct RowCounts {
  std::uint64_t rays = 0;
  std::uint64_t occlusion_rays = 0;
};

/// An element most of whose rays meet back faces lies inside other geometry: it does not count towards its
/// cluster's row, unless all of them do.
inline constexpr float kInvalidShare = 0.5f;

/// Rows of every cluster and lumel of `system`, in the calling task arena. `own_element` per element: whether
/// it is a lumel's own. Cancelled when the observer says so.
Result<SystemRows> trace_system(const RowScene& scene, const std::vector<Chart>& charts,
                                const ClusteredSurface& system, const std::vector<bool>& own_element,
                                const RowOptions& options, RowCounts& counts,
                                const ProgressObserver& observer);

/// Rows of points; `points` lie on no surface (lifted already).
Result<std::vector<FormFactorRow>> trace_sensors(const RowScene& scene, std::span<const SurfacePoint> points,
                                                 const RowOptions& options, RowCounts& counts,
                                                 const ProgressObserver& observer);

}  // namespace relume
