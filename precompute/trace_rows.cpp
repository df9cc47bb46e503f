// SPDX-License-Identifier: MIT
#include "precompute/trace_rows.h"

#include "precompute/assemble_model.h"

namespace relume {
namespace {

std::vector<const FormFactorRow*> pointers_to(const std::vector<FormFactorRow>& rows) {
  std::vector<const FormFactorRow*> pointers;
  for (const FormFactorRow& row : rows) pointers.push_back(&row);
  return pointers;
}

Result<void> trace_systems(const RowScene& scene, const Surfaces& surfaces, const RowPlan& plan,
                           const Survey* survey, RowCounts& counts, const ProgressObserver& observer,
                           TracedRows& rows) {
  for (const ClusteredSurface& surface : surfaces.systems) rows.orders.push_back(stored_order(surface));
  for (std::size_t s = 0; s < surfaces.systems.size(); ++s) {
    const TracedSystem system{surfaces.charts, surfaces.systems[s], surfaces.own_elements[s]};
    if (survey == nullptr) {
      auto traced = trace_system(scene, system, plan.lumels, plan.node_quality, counts, observer);
      if (!traced) return tl::unexpected(traced.error());
      rows.systems.push_back(std::move(*traced));
      continue;
    }
    LumelCutter cutter(*survey, system, rows.orders[s], plan.node_cuts);
    auto traced = trace_system(scene, system, plan.lumels, plan.node_quality, counts, observer,
                               [&](std::uint32_t last, SystemRows& batch) { cutter.take(last, batch); });
    if (!traced) return tl::unexpected(traced.error());
    SystemTiles tiles;
    tiles.lumels = cutter.finish(*traced);
    const std::vector<CutLimits> cuts = cluster_cuts(system, plan.node_cuts);
    tiles.clusters =
        cut_rows(survey->senders.tree, survey->probing, pointers_to(traced->clusters), {kTileRows, cuts});
    traced->clusters = {};
    rows.systems.push_back(std::move(*traced));
    rows.tiles.push_back(std::move(tiles));
  }
  return {};
}

}  // namespace

Result<TracedRows> trace_rows(const RowScene& scene, const Surfaces& surfaces,
                              std::span<const SurfacePoint> sensors, const RowPlan& plan,
                              const Survey* survey, RowCounts& counts, const ProgressObserver& observer) {
  TracedRows rows;
  if (auto traced = trace_systems(scene, surfaces, plan, survey, counts, observer, rows); !traced)
    return tl::unexpected(traced.error());
  auto sensor_rows = trace_sensors(scene, sensors, plan.sensors, counts, observer);
  if (!sensor_rows) return tl::unexpected(sensor_rows.error());
  rows.sensors = std::move(*sensor_rows);
  if (survey != nullptr) {
    rows.tiles.front().sensors = cut_rows(survey->senders.tree, survey->probing,
                                          pointers_to(rows.sensors.rows), {1, {&plan.sensor_cut, 1}});
  }
  return rows;
}

}  // namespace relume
