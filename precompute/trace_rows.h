// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "precompute/light_probes.h"
#include "precompute/reciprocal_rows.h"
#include "precompute/row_plan.h"
#include "precompute/surfaces.h"
#include "precompute/survey.h"
#include "precompute/system_tiles.h"

namespace relume {

/// All rows of a model.
struct TracedRows {
  std::vector<SystemRows> systems;
  std::vector<SystemTiles> tiles;        ///< per system; none without a cut
  std::optional<NodeFlux> flux;          ///< of the nodes that tiles keep
  std::optional<Projection> projection;  ///< of the rows of clusters, where the plan says so
  SensorRows sensors;
  std::vector<std::uint32_t> sensor_systems;  ///< per sensor: the one that it belongs to
  ProbeRows probes;
  std::vector<std::vector<std::uint32_t>> orders;  ///< per system: elements as the model stores them
};

/// Cut against `probing` where the plan says so. In the calling task arena. Cancelled when the observer says
/// so.
Result<TracedRows> trace_rows(const RowScene& scene, const Surfaces& surfaces, const SenderTree& senders,
                              std::span<const SurfacePoint> sensors, std::span<const ProbePoint> probes,
                              const RowPlan& plan, const Probing* probing, RowCounts& counts,
                              const ProgressObserver& observer);

}  // namespace relume
